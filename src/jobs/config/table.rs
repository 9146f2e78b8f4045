//! A table of the configuration while it is read: what is wrong is told with its place and what
//! would be right, and a key that nobody asks for is refused.

use super::document::{Entry, Node, Value};
use crate::jobs::failure::Failure;
use crate::scene::nearest::nearest_hint;
use std::cell::RefCell;
use std::collections::BTreeMap;

/// A table, and what has been asked of it.
pub struct Table<'a> {
    /// Its name with a dot at its end, or nothing for the root.
    path: String,
    place: &'a str,
    entries: &'a BTreeMap<String, Entry>,
    asked: RefCell<Vec<String>>,
}

impl<'a> Table<'a> {
    /// The whole document.
    pub fn root(node: &'a Node) -> Result<Self, Failure> {
        Self::of(node, String::new())
    }

    fn of(node: &'a Node, path: String) -> Result<Self, Failure> {
        match &node.value {
            Value::Table(entries) => Ok(Self {
                path,
                place: &node.place,
                entries,
                asked: RefCell::default(),
            }),
            other => Err(refuse(
                &node.place,
                path.trim_end_matches('.'),
                format!("write a table, not {}", other.kind()),
            )),
        }
    }

    /// Where it is written.
    pub fn place(&self) -> &'a str {
        self.place
    }

    /// The value of a key.
    pub fn node(&self, key: &str) -> Option<&'a Node> {
        self.asked.borrow_mut().push(key.to_string());
        self.entries.get(key).map(|entry| &entry.node)
    }

    /// All its keys, for tables whose keys are names.
    pub fn keys(&self) -> Vec<&'a str> {
        self.entries.keys().map(String::as_str).collect()
    }

    /// Refuses what a key says, at its place; or at the table's if it is missing.
    pub fn error(&self, key: &str, what: impl std::fmt::Display) -> Failure {
        let place = self.entries.get(key).map_or(self.place, |e| &e.node.place);
        refuse(place, &format!("{}{key}", self.path), what)
    }

    fn unlike<T>(&self, key: &str, node: &Node, wanted: &str) -> Result<T, Failure> {
        Err(self.error(key, format!("write {wanted}, not {}", node.value.kind())))
    }

    pub fn text(&self, key: &str) -> Result<Option<String>, Failure> {
        match self.node(key) {
            None => Ok(None),
            Some(node) => match &node.value {
                Value::Text(text) => Ok(Some(text.clone())),
                _ => self.unlike(key, node, "a text in quotes"),
            },
        }
    }

    /// A list of texts.
    pub fn texts(&self, key: &str) -> Result<Option<Vec<String>>, Failure> {
        let Some(node) = self.node(key) else {
            return Ok(None);
        };
        let text = |node: &Node| match &node.value {
            Value::Text(text) => Some(text.clone()),
            _ => None,
        };
        let texts = match &node.value {
            Value::List(list) => list.iter().map(text).collect(),
            _ => None,
        };
        match texts {
            Some(texts) => Ok(Some(texts)),
            None => self.unlike(key, node, "a list of texts, as in [\"a\", \"b\"]"),
        }
    }

    pub fn truth(&self, key: &str, default: bool) -> Result<bool, Failure> {
        match self.node(key) {
            None => Ok(default),
            Some(node) => match node.value {
                Value::Truth(truth) => Ok(truth),
                _ => self.unlike(key, node, "true or false"),
            },
        }
    }

    pub fn number(&self, key: &str) -> Result<Option<f64>, Failure> {
        match self.node(key) {
            None => Ok(None),
            Some(node) => match number(node) {
                Some(number) => Ok(Some(number)),
                None => self.unlike(key, node, "a number"),
            },
        }
    }

    /// A number for which `is_right`; `wanted` says which those are.
    pub fn number_if(
        &self,
        key: &str,
        default: f64,
        wanted: &str,
        is_right: impl Fn(f64) -> bool,
    ) -> Result<f64, Failure> {
        match self.number(key)? {
            None => Ok(default),
            Some(number) if is_right(number) => Ok(number),
            Some(number) => Err(self.error(key, format!("write {wanted}, not {number}"))),
        }
    }

    /// A whole number from `least` to `most`.
    pub fn count(&self, key: &str, least: u64, most: u64) -> Result<Option<u64>, Failure> {
        let wanted = format!("a whole number from {least} to {most}");
        match self.node(key) {
            None => Ok(None),
            Some(node) => match node.value {
                Value::Whole(n) if n >= 0 && (least..=most).contains(&(n as u64)) => {
                    Ok(Some(n as u64))
                }
                Value::Whole(n) => Err(self.error(key, format!("write {wanted}, not {n}"))),
                // With its point: 64.0 is no whole number.
                Value::Number(n) => Err(self.error(key, format!("write {wanted}, not {n:?}"))),
                _ => self.unlike(key, node, &wanted),
            },
        }
    }

    /// One of some names.
    pub fn choice<'n>(&self, key: &str, names: &[&'n str]) -> Result<Option<&'n str>, Failure> {
        let Some(text) = self.text(key)? else {
            return Ok(None);
        };
        self.one_of(key, &text, names).map(Some)
    }

    /// One of some names, for a text that a key's value holds.
    pub fn one_of<'n>(&self, key: &str, text: &str, names: &[&'n str]) -> Result<&'n str, Failure> {
        match names.iter().find(|name| **name == text) {
            Some(name) => Ok(name),
            None => Err(self.error(
                key,
                format!(
                    "there is no \"{text}\"; write one of {}{}",
                    names.join(", "),
                    nearest_hint(text, names.iter().copied())
                ),
            )),
        }
    }

    /// A number alone, or a list of numbers, also of lists of numbers.
    pub fn numbers(&self, key: &str) -> Result<Option<Vec<f64>>, Failure> {
        let Some(node) = self.node(key) else {
            return Ok(None);
        };
        let mut all = Vec::new();
        match flatten(node, &mut all) {
            true => Ok(Some(all)),
            false => self.unlike(key, node, "a number or a list of numbers"),
        }
    }

    /// Values for the `$name`s of a scene.
    pub fn defines(&self, key: &str) -> Result<Vec<(String, String)>, Failure> {
        let Some(inner) = self.table(key)? else {
            return Ok(Vec::new());
        };
        let mut defines = Vec::new();
        for key in inner.keys() {
            let text = match inner.node(key).map(|node| &node.value) {
                Some(Value::Text(text)) => text.clone(),
                Some(Value::Whole(whole)) => whole.to_string(),
                Some(Value::Number(number)) => number.to_string(),
                Some(Value::Truth(truth)) => truth.to_string(),
                _ => return Err(inner.error(key, "write a text, a number, true or false")),
            };
            defines.push((key.to_string(), text));
        }
        Ok(defines)
    }

    /// A table below this one.
    pub fn table(&self, key: &str) -> Result<Option<Table<'a>>, Failure> {
        let path = format!("{}{key}.", self.path);
        self.node(key).map(|node| Table::of(node, path)).transpose()
    }

    /// A list of tables, as `[[view]]` writes it.
    pub fn tables(&self, key: &str) -> Result<Vec<Table<'a>>, Failure> {
        let Some(node) = self.node(key) else {
            return Ok(Vec::new());
        };
        let Value::List(list) = &node.value else {
            let what = format!(
                "write tables, each under [[{key}]], not {}",
                node.value.kind()
            );
            return Err(self.error(key, what));
        };
        let each = list.iter().enumerate();
        each.map(|(i, node)| Table::of(node, format!("{}{key}.{i}.", self.path)))
            .collect()
    }

    /// Refuses keys that nobody has asked for.
    pub fn finish(self) -> Result<(), Failure> {
        let asked = self.asked.borrow();
        for (key, entry) in self.entries {
            if !asked.contains(key) {
                let mut known: Vec<&str> = asked.iter().map(String::as_str).collect();
                known.sort_unstable();
                known.dedup();
                let hint = nearest_hint(key, known.iter().copied());
                let name = self.path.trim_end_matches('.');
                let whose = if name.is_empty() { "the file" } else { name };
                let what = format!("{whose} has no such key{hint} (all: {})", known.join(", "));
                return Err(refuse(&entry.place, &format!("{}{key}", self.path), what));
            }
        }
        Ok(())
    }
}

/// A number, whole or not.
pub fn number(node: &Node) -> Option<f64> {
    match node.value {
        Value::Whole(whole) => Some(whole as f64),
        Value::Number(number) => Some(number),
        _ => None,
    }
}

fn flatten(node: &Node, all: &mut Vec<f64>) -> bool {
    match &node.value {
        Value::List(list) => list.iter().all(|node| flatten(node, all)),
        _ => number(node).map(|number| all.push(number)).is_some(),
    }
}

fn refuse(place: &str, path: &str, what: impl std::fmt::Display) -> Failure {
    match path {
        "" => Failure::Input(format!("{place}: {what}")),
        path => Failure::Input(format!("{place}: {path}: {what}")),
    }
}
