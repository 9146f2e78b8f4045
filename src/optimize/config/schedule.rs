//! Numbers that change while the optimisation goes on.

use crate::jobs::config::document::{Node, Value};
use crate::jobs::config::table::{Table, number};
use crate::jobs::failure::Failure;

/// A number for each step.
#[derive(Clone, Debug, PartialEq)]
pub enum Schedule {
    Constant(f64),
    /// From each of these steps on; the first is 0.
    Steps(Vec<(u64, f64)>),
    /// From `start` at the first step to `end` at the last.
    Between {
        start: f64,
        end: f64,
        how: How,
    },
}

/// The way from one number to another, of a share `t` of the steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum How {
    Linear,
    /// By equal factors.
    Exponential,
    /// By half a period of the cosine \[Loshchilov2017\].
    Cosine,
}

const HOWS: [&str; 3] = ["linear", "exponential", "cosine"];

impl Schedule {
    /// At a step, counted from 0, of so many.
    pub fn at(&self, step: u64, steps: u64) -> f64 {
        match self {
            Schedule::Constant(value) => *value,
            Schedule::Steps(all) => {
                let reached = all.iter().rev().find(|(from, _)| *from <= step);
                reached.map_or(all[0].1, |(_, value)| *value)
            }
            Schedule::Between { start, end, how } => {
                let t = step as f64 / (steps.max(2) - 1) as f64;
                match how {
                    How::Linear => start + (end - start) * t,
                    How::Exponential => start * (end / start).powf(t),
                    How::Cosine => {
                        end + (start - end) * 0.5 * (1.0 + (std::f64::consts::PI * t).cos())
                    }
                }
            }
        }
    }

    /// All numbers that it names.
    fn values(&self) -> Vec<f64> {
        match self {
            Schedule::Constant(value) => vec![*value],
            Schedule::Steps(all) => all.iter().map(|(_, value)| *value).collect(),
            Schedule::Between { start, end, .. } => vec![*start, *end],
        }
    }

    /// Reads `0.1`, `[[0, 0.1], [50, 0.01]]` or `{ start = 0.1, end = 0.01, how = "cosine" }`;
    /// `wanted` says which numbers are right.
    pub fn read(
        table: &Table,
        key: &str,
        wanted: &str,
        is_right: impl Fn(f64) -> bool,
    ) -> Result<Option<Self>, Failure> {
        let Some(node) = table.node(key) else {
            return Ok(None);
        };
        let schedule = match &node.value {
            Value::Whole(_) | Value::Number(_) => Schedule::Constant(number(node).unwrap_or(0.0)),
            Value::List(list) => Schedule::Steps(pairs(list).ok_or_else(|| {
                let what = "write a number, or pairs of a step and a number of which the first is of step 0 and \
                            the steps increase: [[0, 4], [50, 16]]";
                table.error(key, what)
            })?),
            Value::Table(_) => between(table, key)?,
            other => {
                let what = format!("write {wanted}, not {}", other.kind());
                return Err(table.error(key, what));
            }
        };
        match schedule
            .values()
            .into_iter()
            .find(|value| !is_right(*value))
        {
            None => Ok(Some(schedule)),
            Some(bad) => Err(table.error(key, format!("write {wanted}, not {bad}"))),
        }
    }
}

fn pairs(list: &[Node]) -> Option<Vec<(u64, f64)>> {
    let pair = |node: &Node| match &node.value {
        Value::List(pair) => match pair.as_slice() {
            [step, value] => match step.value {
                Value::Whole(step) => Some((u64::try_from(step).ok()?, number(value)?)),
                _ => None,
            },
            _ => None,
        },
        _ => None,
    };
    let all: Vec<(u64, f64)> = list.iter().map(pair).collect::<Option<_>>()?;
    let increases = all.windows(2).all(|pair| pair[0].0 < pair[1].0);
    (all.first().is_some_and(|first| first.0 == 0) && increases).then_some(all)
}

fn between(table: &Table, key: &str) -> Result<Schedule, Failure> {
    let Some(inner) = table.table(key)? else {
        return Ok(Schedule::Constant(0.0));
    };
    let missing =
        |name: &str| inner.error(name, "it is missing; write { start = 0.1, end = 0.01 }");
    let start = inner.number("start")?.ok_or_else(|| missing("start"))?;
    let end = inner.number("end")?.ok_or_else(|| missing("end"))?;
    let how = match inner.choice("how", &HOWS)? {
        Some("linear") => How::Linear,
        Some("cosine") => How::Cosine,
        _ => How::Exponential,
    };
    if how == How::Exponential && !(start > 0.0 && end > 0.0) {
        let what = "an exponential way is between numbers above zero; write how = \"linear\"";
        return Err(inner.error("start", what));
    }
    inner.finish()?;
    Ok(Schedule::Between { start, end, how })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jobs::config::document::parse;

    fn read(text: &str) -> Result<Schedule, Failure> {
        let node = parse(text, "f")?;
        let table = Table::root(&node)?;
        Ok(Schedule::read(&table, "a", "a number above zero", |v| v > 0.0)?.unwrap())
    }

    #[test]
    fn the_ways_pass_through_their_ends() {
        for how in HOWS {
            let text = format!("a = {{ start = 4, end = 1, how = \"{how}\" }}");
            let schedule = read(&text).unwrap();
            assert!((schedule.at(0, 11) - 4.0).abs() < 1e-12, "{how}");
            assert!((schedule.at(10, 11) - 1.0).abs() < 1e-12, "{how}");
        }
        let middle = |how: &str| {
            let text = format!("a = {{ start = 4, end = 1, how = \"{how}\" }}");
            read(&text).unwrap().at(5, 11)
        };
        assert!((middle("linear") - 2.5).abs() < 1e-12);
        assert!((middle("exponential") - 2.0).abs() < 1e-12);
        assert!((middle("cosine") - 2.5).abs() < 1e-12);
        let steps = read("a = [[0, 4], [3, 16]]").unwrap();
        let seen: Vec<f64> = (0..5).map(|step| steps.at(step, 5)).collect();
        assert_eq!(seen, [4.0, 4.0, 4.0, 16.0, 16.0]);
    }

    #[test]
    fn what_is_no_schedule_is_refused() {
        for text in [
            "a = \"x\"",
            "a = -1",
            "a = []",
            "a = [[1, 4]]",
            "a = [[0, 4], [0, 5]]",
            "a = { start = 1 }",
            "a = { start = 1, end = 2, way = 1 }",
            "a = [[0, 1], [2, -1]]",
        ] {
            assert!(read(text).is_err(), "{text}");
        }
    }
}
