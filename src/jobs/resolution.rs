//! Width and height of an image, as they are written.

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::Deserialize;
use std::borrow::Cow;

/// Largest width or height; past it a typing error is likelier than a wish.
const LARGEST_SIDE: u32 = 65_536;

/// Width and height in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(try_from = "Sides")]
pub struct Resolution(pub [u32; 2]);

#[derive(Deserialize, JsonSchema)]
#[serde(untagged, expecting = "write [width, height] or \"WIDTHxHEIGHT\"")]
enum Sides {
    Pair(#[schemars(inner(range(min = 1, max = 65536)))] [u32; 2]),
    Text(#[schemars(regex(pattern = r"^[0-9]+[xX][0-9]+$"))] String),
}

impl TryFrom<Sides> for Resolution {
    type Error = String;

    fn try_from(sides: Sides) -> Result<Self, String> {
        match sides {
            Sides::Pair(sides) => check_resolution(sides),
            Sides::Text(text) => resolution(&text),
        }
        .map(Resolution)
    }
}

impl JsonSchema for Resolution {
    fn schema_name() -> Cow<'static, str> {
        "Resolution".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        Sides::json_schema(generator)
    }
}

/// Reads `WxH`.
pub fn resolution(text: &str) -> Result<[u32; 2], String> {
    let wrong = || "write width x height, as in 640x480".to_string();
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(wrong)?;
    let side = |text: &str| text.parse::<u32>().map_err(|_| wrong());
    check_resolution([side(width)?, side(height)?])
}

/// The same, if it is one that an image can have.
pub fn check_resolution(sides: [u32; 2]) -> Result<[u32; 2], String> {
    match sides.iter().all(|side| (1..=LARGEST_SIDE).contains(side)) {
        true => Ok(sides),
        false => Err(format!("each side is from 1 to {LARGEST_SIDE} pixels")),
    }
}
