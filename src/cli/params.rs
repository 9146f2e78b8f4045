//! `warpath params`: every parameter, as a table or as JSON.

use super::arguments::ParamsArguments;
use super::exit::Failure;
use super::log::{Log, harmless};
use super::session;
use super::signals::Signals;
use crate::output::npy;
use crate::scene::parameters::{self, Parameter, Value};
use serde_json::json;
use std::io::Write;

/// More numbers than this are shown as a range.
const NUMBERS_SHOWN: usize = 4;

const COLUMNS: [&str; 5] = ["KEY", "SHAPE", "FLAGS", "VALUE", "ALSO"];

/// Prints the list on stdout.
pub fn run(arguments: &ParamsArguments) -> Result<(), Failure> {
    let log = Log::new(&arguments.talk);
    Signals::watch(log);
    let scene = session::load_to_list(&arguments.scene, log)?;
    let list = parameters::list(&scene);
    let text = if arguments.talk.json {
        let list: Vec<_> = list.iter().map(object).collect();
        format!("{:#}\n", serde_json::Value::from(list))
    } else {
        table(&list)
    };
    let mut stdout = std::io::stdout().lock();
    stdout.write_all(text.as_bytes())?;
    Ok(stdout.flush()?)
}

fn object(p: &Parameter) -> serde_json::Value {
    let value = match &p.value {
        Value::Numbers(numbers) => json!(numbers.iter().map(|v| short(*v)).collect::<Vec<_>>()),
        Value::Range { min, max } => json!({"min": short(*min), "max": short(*max)}),
    };
    json!({
        "key": p.key, "shape": p.shape, "value": value, "aliases": p.aliases,
        "differentiable": p.differentiable, "moves_visibility": p.moves_visibility,
    })
}

/// The shortest decimal number that is the same 32-bit float: 0.2 is not 0.20000000298.
fn short(value: f64) -> f64 {
    (value as f32).to_string().parse().unwrap_or(value)
}

fn table(list: &[Parameter]) -> String {
    let rows: Vec<[String; 5]> = std::iter::once(COLUMNS.map(String::from))
        .chain(list.iter().map(|p| row(p).map(|cell| harmless(&cell))))
        .collect();
    // The last column is not padded: the other names of one colour can be very many.
    let widths: [usize; 4] = std::array::from_fn(|column| {
        let cells = rows.iter().map(|row| row[column].chars().count());
        cells.max().unwrap_or_default()
    });
    let mut text = String::new();
    for [first @ .., last] in &rows {
        let mut line = String::new();
        for (cell, width) in first.iter().zip(widths) {
            let padding = " ".repeat(width - cell.chars().count());
            line += &format!("{cell}{padding}  ");
        }
        line += last;
        text += line.trim_end();
        text += "\n";
    }
    text + "\n∂ can be differentiated, v moves what hides what; ALSO: other names of the same parameter\n"
}

fn row(p: &Parameter) -> [String; 5] {
    let flags = match (p.differentiable, p.moves_visibility) {
        (true, true) => "∂ v",
        (true, false) => "∂",
        (false, true) => "  v",
        (false, false) => "",
    };
    [
        p.key.clone(),
        npy::tuple(&p.shape),
        flags.into(),
        value(&p.value),
        p.aliases.join(", "),
    ]
}

fn value(value: &Value) -> String {
    match value {
        Value::Numbers(numbers) if numbers.len() <= NUMBERS_SHOWN => {
            let numbers: Vec<String> = numbers.iter().map(|v| shown(*v)).collect();
            numbers.join(", ")
        }
        Value::Numbers(numbers) => {
            let min = numbers.iter().copied().fold(f64::INFINITY, f64::min);
            let max = numbers.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            range(min, max)
        }
        Value::Range { min, max } => range(*min, *max),
    }
}

fn range(min: f64, max: f64) -> String {
    // The fold of no numbers.
    if min > max {
        return String::new();
    }
    format!("{} … {}", shown(min), shown(max))
}

/// Six digits at most: enough to recognise a value by.
fn shown(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    match rounded.abs() {
        0.0 => "0".into(),
        a if (1e-4..1e7).contains(&a) => rounded.to_string(),
        _ => format!("{rounded:e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let known = [
            (0.0, "0"),
            (-0.0, "0"),
            (f64::from(0.2f32), "0.2"),
            (1.0 / 3.0, "0.333333"),
            (-1234567.8, "-1234570"),
            (1e-7, "1e-7"),
            (3e38, "3e38"),
        ];
        for (number, text) in known {
            assert_eq!(shown(number), text);
        }
        assert_eq!(short(f64::from(0.1f32)), 0.1);
    }
}
