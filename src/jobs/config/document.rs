//! A TOML document as a tree in which every value knows its place, and the overrides of the command
//! line put into it.

use crate::jobs::failure::Failure;
use std::collections::BTreeMap;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A value and where it is written: `config.toml:3:5`, or `--set optimizer.lr=0.1`.
#[derive(Clone, Debug)]
pub struct Node {
    pub place: String,
    pub value: Value,
}

/// What a value is.
#[derive(Clone, Debug)]
pub enum Value {
    Text(String),
    Whole(i64),
    Number(f64),
    Truth(bool),
    List(Vec<Node>),
    Table(BTreeMap<String, Entry>),
}

/// A key of a table with its value.
#[derive(Clone, Debug)]
pub struct Entry {
    pub place: String,
    pub node: Node,
}

impl Value {
    /// As it stands in messages.
    pub fn kind(&self) -> &'static str {
        match self {
            Value::Text(_) => "a text",
            Value::Whole(_) => "a whole number",
            Value::Number(_) => "a number",
            Value::Truth(_) => "true or false",
            Value::List(_) => "a list",
            Value::Table(_) => "a table",
        }
    }
}

/// Reads a document; `file` is what it is called in messages.
pub fn parse(text: &str, file: &str) -> Result<Node, Failure> {
    let place = |at: usize| {
        let (line, column) = line_and_column(text, at);
        format!("{file}:{line}:{column}")
    };
    read(text, &place)
}

/// Puts `path=value` of the command line into a document. The path is that of a TOML key, a number
/// picks from a list; a value that is no TOML is a text.
pub fn set(root: &mut Node, typed: &str) -> Result<(), Failure> {
    let place = format!("--set {typed}");
    let Some((path, value)) = split(typed) else {
        return Err(Failure::Usage(format!(
            "{place}: the value is missing; write --set KEY=VALUE, as in --set seed=2"
        )));
    };
    let at = |_: usize| place.clone();
    let quoted = format!("value = {}", toml_text(value));
    let parsed = read(&format!("value = {value}"), &at).or_else(|_| read(&quoted, &at))?;
    let Value::Table(mut table) = parsed.value else {
        return Ok(());
    };
    let Some(Entry { node, .. }) = table.remove("value") else {
        return Ok(());
    };
    let keys = keys(path, &place)?;
    put(root, &keys, node, &place)
}

/// At the first `=` that no quotes hold.
fn split(typed: &str) -> Option<(&str, &str)> {
    let mut quote = None;
    for (at, c) in typed.char_indices() {
        match (c, quote) {
            ('=', None) => return Some((&typed[..at], &typed[at + 1..])),
            ('"' | '\'', None) => quote = Some(c),
            (c, Some(open)) if c == open => quote = None,
            _ => {}
        }
    }
    None
}

fn toml_text(text: &str) -> String {
    let escaped = text.replace('\\', "\\\\").replace('"', "\\\"");
    format!("\"{escaped}\"")
}

/// The keys of a dotted path.
fn keys(path: &str, place: &str) -> Result<Vec<String>, Failure> {
    let wrong = || {
        Failure::Usage(format!(
            "{place}: {path} is no key; write names with dots between, quoted where they hold dots: \
             parameters.\"ball.translation\".lr"
        ))
    };
    let mut node = read(&format!("{path} = 0"), &|_| place.to_string()).map_err(|_| wrong())?;
    let mut keys = Vec::new();
    loop {
        match node.value {
            Value::Table(mut table) => {
                let (key, entry) = table.pop_first().ok_or_else(wrong)?;
                keys.push(key);
                node = entry.node;
            }
            _ => return Ok(keys),
        }
    }
}

fn put(root: &mut Node, keys: &[String], value: Node, place: &str) -> Result<(), Failure> {
    let mut at = root;
    for (depth, key) in keys.iter().enumerate() {
        let is_last = depth + 1 == keys.len();
        let next = match &mut at.value {
            Value::Table(table) => {
                let fresh = || Entry {
                    place: place.to_string(),
                    node: Node {
                        place: place.to_string(),
                        value: Value::Table(BTreeMap::new()),
                    },
                };
                &mut table.entry(key.clone()).or_insert_with(fresh).node
            }
            Value::List(list) => {
                let count = list.len();
                let picked = key.parse::<usize>().ok().and_then(|i| list.get_mut(i));
                picked.ok_or_else(|| {
                    let what = format!("{key} is no number below {count}, the length of the list");
                    Failure::Usage(format!("{place}: {what}"))
                })?
            }
            _ => {
                let what = format!("{key} stands below a value that is no table");
                return Err(Failure::Usage(format!("{place}: {what}")));
            }
        };
        if is_last {
            *next = value;
            return Ok(());
        }
        at = next;
    }
    Ok(())
}

fn read(text: &str, place: &dyn Fn(usize) -> String) -> Result<Node, Failure> {
    let table = DeTable::parse(text).map_err(|error| {
        let at = place(error.span().map_or(0, |span| span.start));
        let what = match error.message().trim() {
            "duplicate key" => "this key is written twice; take one out",
            other => other,
        };
        Failure::Input(format!("{at}: not TOML: {what}"))
    })?;
    let at = place(0);
    let value = of_table(table.into_inner(), place)?;
    Ok(Node { place: at, value })
}

fn of_table(table: DeTable, place: &dyn Fn(usize) -> String) -> Result<Value, Failure> {
    let mut entries = BTreeMap::new();
    for (key, value) in table {
        let at = place(key.span().start);
        let node = of_value(value, place)?;
        entries.insert(key.into_inner().into_owned(), Entry { place: at, node });
    }
    Ok(Value::Table(entries))
}

fn of_value(value: Spanned<DeValue>, place: &dyn Fn(usize) -> String) -> Result<Node, Failure> {
    let at = place(value.span().start);
    let wrong = |what: String| Failure::Input(format!("{at}: {what}"));
    let value = match value.into_inner() {
        DeValue::String(text) => Value::Text(text.into_owned()),
        DeValue::Boolean(truth) => Value::Truth(truth),
        DeValue::Integer(number) => {
            let whole = i64::from_str_radix(number.as_str(), number.radix());
            Value::Whole(whole.map_err(|_| wrong(format!("{number} is too large a number")))?)
        }
        DeValue::Float(number) => match number.as_str().parse::<f64>() {
            Ok(number) if number.is_finite() => Value::Number(number),
            _ => return Err(wrong(format!("{number} is not a finite number"))),
        },
        DeValue::Datetime(_) => {
            let what = "a date or a time; write a number, or a text in quotes".to_string();
            return Err(wrong(what));
        }
        DeValue::Array(list) => Value::List(
            list.into_iter()
                .map(|item| of_value(item, place))
                .collect::<Result<_, _>>()?,
        ),
        DeValue::Table(table) => of_table(table, place)?,
    };
    Ok(Node { place: at, value })
}

/// Both from 1, columns in characters.
fn line_and_column(text: &str, at: usize) -> (usize, usize) {
    // A place within a character is that of the character.
    let end = (0..=at.min(text.len()))
        .rev()
        .find(|&i| text.is_char_boundary(i));
    let before = &text[..end.unwrap_or(0)];
    let line = before.matches('\n').count() + 1;
    let start = before.rfind('\n').map_or(0, |newline| newline + 1);
    (line, before[start..].chars().count() + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at<'a>(node: &'a Node, keys: &[&str]) -> &'a Node {
        keys.iter().fold(node, |node, key| match &node.value {
            Value::Table(table) => &table[*key].node,
            Value::List(list) => &list[key.parse::<usize>().unwrap()],
            _ => panic!("{key} is below no table"),
        })
    }

    #[test]
    fn values_know_their_places() {
        let root = parse("a = 1\n[b]\n  'ü.c' = [2.5, \"x\"]\n", "f.toml").unwrap();
        assert_eq!(at(&root, &["a"]).place, "f.toml:1:5");
        assert_eq!(at(&root, &["b", "ü.c", "1"]).place, "f.toml:3:17");
        let wrong = parse("a = 1\nb = = 2\n", "f.toml").unwrap_err().to_string();
        assert!(wrong.starts_with("f.toml:2:5: not TOML"), "{wrong}");
        for text in ["a = nan", "a = 99999999999999999999", "a = 1979-05-27"] {
            assert!(parse(text, "f.toml").is_err(), "{text}");
        }
    }

    #[test]
    fn the_command_line_overrides() {
        let mut root = parse("[a]\nb = 1\n[[l]]\nx = 1\n", "f.toml").unwrap();
        for typed in ["a.b=2.5", "a.\"c.d\"=adam", "l.0.x=[1, 2]", "new.one=true"] {
            set(&mut root, typed).unwrap();
        }
        assert!(matches!(at(&root, &["a", "b"]).value, Value::Number(2.5)));
        assert!(matches!(&at(&root, &["a", "c.d"]).value, Value::Text(t) if t == "adam"));
        assert!(matches!(&at(&root, &["l", "0", "x"]).value, Value::List(l) if l.len() == 2));
        assert_eq!(at(&root, &["new", "one"]).place, "--set new.one=true");
        for wrong in ["a.b", "a b=1", "a.b.c=1", "l.7.x=1", "=1"] {
            assert_eq!(set(&mut root, wrong).unwrap_err().code(), 2, "{wrong}");
        }
    }
}
