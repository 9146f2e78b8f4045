//! How numbers are written in JSON.

use super::numbers::Numbers;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{self, Deserialize, DeserializeSeed, Deserializer, SeqAccess, Visitor};
use std::borrow::Cow;
use std::fmt;

impl<'de> Deserialize<'de> for Numbers {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(NumbersVisitor)
    }
}

const WANTED: &str =
    "a number, a list of numbers (or of lists of them), or the name of a .npy or .safetensors file";

struct NumbersVisitor;

impl<'de> Visitor<'de> for NumbersVisitor {
    type Value = Numbers;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(WANTED)
    }

    fn visit_str<E: de::Error>(self, text: &str) -> Result<Numbers, E> {
        match text {
            "" => Err(E::invalid_value(de::Unexpected::Str(text), &self)),
            file => Ok(Numbers::File(file.into())),
        }
    }

    fn visit_f64<E: de::Error>(self, number: f64) -> Result<Numbers, E> {
        Ok(Numbers::Inline {
            values: vec![finite(number)?],
            shape: Vec::new(),
        })
    }

    fn visit_i64<E: de::Error>(self, number: i64) -> Result<Numbers, E> {
        self.visit_f64(number as f64)
    }

    fn visit_u64<E: de::Error>(self, number: u64) -> Result<Numbers, E> {
        self.visit_f64(number as f64)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Numbers, A::Error> {
        let mut values = Vec::new();
        let shape = Nested {
            values: &mut values,
        }
        .visit_seq(list)?;
        Ok(Numbers::Inline { values, shape })
    }
}

fn finite<E: de::Error>(number: f64) -> Result<f32, E> {
    let value = number as f32;
    match value.is_finite() {
        true => Ok(value),
        false => Err(E::custom(format!("{number} is too large a number"))),
    }
}

/// A number or a list in a list: adds its numbers to `values` and gives its shape.
struct Nested<'a> {
    values: &'a mut Vec<f32>,
}

impl<'de> DeserializeSeed<'de> for Nested<'_> {
    type Value = Vec<usize>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Vec<usize>, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Nested<'_> {
    type Value = Vec<usize>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number or a list of numbers")
    }

    fn visit_f64<E: de::Error>(self, number: f64) -> Result<Vec<usize>, E> {
        self.values.push(finite(number)?);
        Ok(Vec::new())
    }

    fn visit_i64<E: de::Error>(self, number: i64) -> Result<Vec<usize>, E> {
        self.visit_f64(number as f64)
    }

    fn visit_u64<E: de::Error>(self, number: u64) -> Result<Vec<usize>, E> {
        self.visit_f64(number as f64)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Vec<usize>, A::Error> {
        let mut row: Option<Vec<usize>> = None;
        let mut count = 0;
        while let Some(shape) = list.next_element_seed(Nested {
            values: &mut *self.values,
        })? {
            count += 1;
            match &row {
                Some(first) if *first != shape => {
                    return Err(de::Error::custom("its rows are not of one length"));
                }
                _ => row = Some(shape),
            }
        }
        let mut shape = vec![count];
        shape.extend(row.unwrap_or_default());
        Ok(shape)
    }
}

impl JsonSchema for Numbers {
    fn schema_name() -> Cow<'static, str> {
        "Numbers".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "The numbers of a parameter: one, a list (row by row), lists of lists of its shape, or the name of a .npy file of its shape or of a .safetensors file with a tensor of its key",
            "anyOf": [
                { "type": "number" },
                { "type": "string", "minLength": 1 },
                { "type": "array", "items": { "type": ["number", "array"] } }
            ]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Numbers, String> {
        serde_json::from_str(text).map_err(|error| error.to_string())
    }

    fn shape(text: &str) -> Vec<usize> {
        match parse(text) {
            Ok(Numbers::Inline { shape, .. }) => shape,
            other => panic!("{text}: {other:?}"),
        }
    }

    #[test]
    fn numbers_have_the_shape_they_are_typed_in() {
        assert!(shape("2").is_empty());
        assert_eq!(shape("[1, 2.5, -3e1]"), [3]);
        assert_eq!(shape("[[1,2,3],[4,5,6]]"), [2, 3]);
        assert_eq!(shape("[[[1],[2]]]"), [1, 2, 1]);
        assert_eq!(parse("\"a.npy\""), Ok(Numbers::File("a.npy".into())));
        for wrong in [
            "\"\"",
            "[1,[2]]",
            "[[1],[2,3]]",
            "[1e99]",
            "[null]",
            "true",
            "{}",
        ] {
            assert!(parse(wrong).is_err(), "{wrong}");
        }
    }
}
