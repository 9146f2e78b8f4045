//! What is refused before the text is parsed, because parsing it would take time that grows with
//! the square of its length: the parser compares every attribute of an element, and every namespace
//! in scope, with each other.

/// Elements inside elements, counted through includes.
pub(super) const MAX_DEPTH: usize = 64;
/// Attributes of one element; those of scenes have five at most.
const MAX_ATTRIBUTES: usize = 64;

/// The first element that is too much, by its first byte, and what is wrong with it. What is not
/// well-formed is left to the parser: up to there this sees what it sees.
pub(super) fn too_much(text: &str) -> Option<(usize, String)> {
    let bytes = text.as_bytes();
    let mut at = 0;
    let mut depth = 0_usize;
    while let Some(next) = find(bytes, at, b"<") {
        let rest = &bytes[next..];
        let skipped = [
            (&b"<!--"[..], &b"-->"[..]),
            (b"<![CDATA[", b"]]>"),
            (b"<?", b"?>"),
        ]
        .into_iter()
        .find(|(open, _)| rest.starts_with(open));
        if let Some((open, close)) = skipped {
            at = find(bytes, next + open.len(), close)? + close.len();
            continue;
        }
        let tag = Tag::read(bytes, next + 1)?;
        at = tag.end;
        if rest.starts_with(b"</") {
            depth = depth.saturating_sub(1);
            continue;
        }
        if depth > MAX_DEPTH {
            return Some((next, nested_too_deep()));
        }
        if tag.attributes > MAX_ATTRIBUTES {
            let what = format!("an element has more than {MAX_ATTRIBUTES} attributes");
            return Some((next, what));
        }
        if tag.has_namespace {
            let what = "scenes have no namespaces: leave xmlns out";
            return Some((next, what.to_string()));
        }
        depth += usize::from(!tag.is_empty);
    }
    None
}

pub(super) fn nested_too_deep() -> String {
    format!("elements are nested more than {MAX_DEPTH} deep")
}

struct Tag {
    /// After its `>`.
    end: usize,
    attributes: usize,
    has_namespace: bool,
    /// `<…/>`
    is_empty: bool,
}

impl Tag {
    /// Reads on from after the `<`; `None` if the text ends first.
    fn read(bytes: &[u8], from: usize) -> Option<Self> {
        let mut tag = Self {
            end: 0,
            attributes: 0,
            has_namespace: false,
            is_empty: false,
        };
        let mut at = from;
        loop {
            match *bytes.get(at)? {
                b'>' => {
                    tag.is_empty = bytes[at - 1] == b'/';
                    tag.end = at + 1;
                    return Some(tag);
                }
                quote @ (b'"' | b'\'') => at = find(bytes, at + 1, &[quote])?,
                b'=' => tag.attributes += 1,
                b'x' if bytes[at - 1].is_ascii_whitespace() => {
                    tag.has_namespace |= bytes[at..].starts_with(b"xmlns");
                }
                _ => {}
            }
            at += 1;
        }
    }
}

fn find(bytes: &[u8], from: usize, what: &[u8]) -> Option<usize> {
    let rest = bytes.get(from..)?;
    let found = rest.windows(what.len()).position(|part| part == what)?;
    Some(from + found)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn attributes(count: usize) -> String {
        (0..count).map(|i| format!(" a{i}='=>'")).collect()
    }

    #[test]
    fn what_is_no_attribute_is_not_counted() {
        let most = attributes(MAX_ATTRIBUTES);
        let text = format!(
            "<?xml a='1'?><!-- <b{most}{most}/> <a xmlns=''> --><a{most}><![CDATA[<c{most} d=''>]]>= x=y<b{most}/></a>"
        );
        assert_eq!(too_much(&text), None);
        for unfinished in ["<", "<a", "<a b='", "<!-- <a", "<![CDATA[", "</", "é<"] {
            assert_eq!(too_much(unfinished), None, "{unfinished}");
        }
    }

    #[test]
    fn the_first_element_that_is_too_much_is_named() {
        let many = attributes(MAX_ATTRIBUTES + 1);
        let (at, what) = too_much(&format!("<a>é<b{many}/></a>")).unwrap();
        assert_eq!((at, what.contains("64 attributes")), (5, true), "{what}");
        let (at, what) = too_much("<a>\n<b\txmlns:c='d'/></a>").unwrap();
        assert_eq!((at, what.contains("xmlns")), (4, true), "{what}");
        let nested = |depth: usize| "<a>".repeat(depth) + "<b/>" + &"</a>".repeat(depth) + "<b/>";
        assert_eq!(too_much(&nested(MAX_DEPTH)), None);
        let (at, _) = too_much(&nested(MAX_DEPTH + 1)).unwrap();
        assert_eq!(at, 3 * (MAX_DEPTH + 1));
    }
}
