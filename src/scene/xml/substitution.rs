//! `$name` in attribute values, from `<default>` elements and `-D name=value`.

use crate::scene::nearest::{first_names, mistyped, shown};
use std::collections::BTreeMap;

/// Longest attribute value after substitution: defaults built from defaults double in size each
/// time.
const LONGEST_VALUE_BYTES: usize = 1 << 20;

/// The names that can stand after a `$`, and which `-D` were of use.
#[derive(Debug, Default)]
pub(super) struct Substitutions {
    values: BTreeMap<String, String>,
    /// Names given by `-D`, and whether one was substituted.
    defines: BTreeMap<String, bool>,
    /// Names of `<default>` elements met.
    defaults: Vec<String>,
}

impl Substitutions {
    /// With what `-D` gives. A later one of the same name wins.
    pub fn new(defines: &[(String, String)]) -> Self {
        Self {
            values: defines.iter().cloned().collect(),
            defines: defines.iter().map(|(n, _)| (n.clone(), false)).collect(),
            defaults: Vec::new(),
        }
    }

    /// A `<default>`: does not override a `-D` or an earlier default.
    pub fn set_default(&mut self, name: &str, value: &str) {
        self.values
            .entry(name.to_string())
            .or_insert_with(|| value.to_string());
        self.defaults.push(name.to_string());
    }

    /// `text` with every `$name` replaced; `\$` is a plain dollar sign. The error is a sentence.
    ///
    /// As in Mitsuba, the longest known name that the text after `$` begins with is meant, so that
    /// `mesh$n_low.ply` works with a parameter `n`.
    pub fn substitute(&mut self, text: &str) -> Result<String, String> {
        let mut out = String::with_capacity(text.len());
        let mut rest = text;
        while let Some(at) = rest.find('$') {
            if let Some(before) = rest[..at].strip_suffix('\\') {
                out.push_str(before);
                out.push('$');
                rest = &rest[at + 1..];
                continue;
            }
            out.push_str(&rest[..at]);
            let after = &rest[at + 1..];
            let known = self.values.iter().filter(|(n, _)| after.starts_with(*n));
            let Some((name, value)) = known.max_by_key(|(n, _)| n.len()) else {
                return Err(self.unknown(after));
            };
            out.push_str(value);
            if out.len() > LONGEST_VALUE_BYTES {
                return Err(format!(
                    "the value is longer than {LONGEST_VALUE_BYTES} bytes after substituting ${name}"
                ));
            }
            rest = &after[name.len()..];
            if let Some(used) = self.defines.get_mut(name) {
                *used = true;
            }
        }
        out.push_str(rest);
        Ok(out)
    }

    fn unknown(&self, after: &str) -> String {
        let is_name = |c: char| c.is_alphanumeric() || c == '_';
        let name: String = after.chars().take_while(|&c| is_name(c)).collect();
        let names = self.values.keys().map(String::as_str);
        let hint = match mistyped(&name, names.clone()) {
            Some(near) => format!("the nearest known parameter is ${near}"),
            None => match first_names(names.map(|name| format!("${name}"))) {
                Some(names) => format!("there are {names}"),
                None => "the scene declares no parameter".to_string(),
            },
        };
        format!(
            "undefined parameter ${}; {hint}; declare it with <default name=\"{0}\" value=\"…\"/> or give -D {0}=…",
            shown(&name)
        )
    }

    /// The first `-D` that nothing used, as a sentence.
    pub fn unused_define(&self) -> Option<String> {
        let (name, _) = self.defines.iter().find(|(_, used)| !**used)?;
        let shown = shown(name);
        if self.defaults.contains(name) {
            return Some(format!(
                "-D {shown}: the scene declares this parameter but uses it nowhere"
            ));
        }
        let names = self.defaults.iter().map(String::as_str);
        if let Some(near) = mistyped(name, names.clone()) {
            return Some(format!(
                "-D {shown}: the scene has no such parameter; the nearest is \"{near}\""
            ));
        }
        Some(match first_names(names.map(String::from)) {
            Some(names) => format!("-D {shown}: the scene has no such parameter; it has {names}"),
            None => format!("-D {shown}: the scene declares no parameters"),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn substitutes_longest_name_and_escapes() {
        let mut s = Substitutions::new(&[("res".into(), "64".into())]);
        s.set_default("res", "128");
        s.set_default("resx", "7");
        assert_eq!(
            s.substitute("$res,$resx,a$res_b,\\$res").unwrap(),
            "64,7,a64_b,$res"
        );
        assert_eq!(s.unused_define(), None);
        assert!(s.substitute("$nope").unwrap_err().contains("$nope"));
    }

    #[test]
    fn names_the_nearest_default_of_an_unused_define() {
        let mut s = Substitutions::new(&[("rez".into(), "64".into())]);
        s.set_default("res", "128");
        assert!(s.unused_define().unwrap().contains("\"res\""));
    }

    #[test]
    fn growth_is_bounded() {
        let mut s = Substitutions::new(&[]);
        s.set_default("a0", "xxxxxxxxxxxxxxxx");
        let mut failed = false;
        for i in 0..64 {
            match s.substitute(&format!("$a{i}$a{i}")) {
                Ok(v) => s.set_default(&format!("a{}", i + 1), &v),
                Err(_) => {
                    failed = true;
                    break;
                }
            }
        }
        assert!(failed);
    }
}
