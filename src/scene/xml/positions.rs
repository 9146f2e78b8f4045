//! Lines and columns of byte offsets, in time that does not grow with the file or with the length
//! of its lines.

/// Bytes between two offsets whose characters are counted beforehand.
const STRIDE: usize = 256;

/// Where the lines of a text begin, and how many characters are before every [`STRIDE`]th byte.
pub(super) struct Positions {
    line_starts: Vec<usize>,
    characters: Vec<usize>,
}

impl Positions {
    /// Of `text`.
    pub fn of(text: &str) -> Self {
        let after_newlines = text.match_indices('\n').map(|(at, _)| at + 1);
        let mut characters = vec![0];
        for chunk in text.as_bytes().chunks(STRIDE) {
            characters.push(characters[characters.len() - 1] + begun_in(chunk));
        }
        Self {
            line_starts: std::iter::once(0).chain(after_newlines).collect(),
            characters,
        }
    }

    /// Line and column of a byte of `text`, both from 1; columns count characters.
    pub fn of_byte(&self, text: &str, at: usize) -> (u32, u32) {
        let line = self.line_starts.partition_point(|&start| start <= at);
        let start = self.line_starts[line - 1];
        let column = self.before(text, at) - self.before(text, start) + 1;
        (line as u32, column as u32)
    }

    /// Characters before a byte.
    fn before(&self, text: &str, at: usize) -> usize {
        let counted = at / STRIDE;
        self.characters[counted] + begun_in(&text.as_bytes()[counted * STRIDE..at])
    }
}

/// Characters of UTF-8 that begin among these bytes.
fn begun_in(bytes: &[u8]) -> usize {
    bytes.iter().filter(|&&byte| byte & 0xc0 != 0x80).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_has_the_place_that_counting_gives() {
        let text = format!(
            "ab\n\n{}ö€𝄞{}\nö\n",
            "é".repeat(STRIDE),
            "x".repeat(2 * STRIDE)
        );
        let positions = Positions::of(&text);
        let ends = text.char_indices().map(|(at, _)| at).chain([text.len()]);
        for at in ends {
            let before = &text[..at];
            let line = before.matches('\n').count() + 1;
            let column = before.rsplit('\n').next().unwrap_or("").chars().count() + 1;
            let expected = (line as u32, column as u32);
            assert_eq!(positions.of_byte(&text, at), expected, "{at}");
        }
    }
}
