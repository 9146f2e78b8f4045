//! How a `.npy` file begins: which numbers follow, of what shape and in which order.

use super::shape;

/// What is known before the numbers are read.
#[derive(Debug)]
pub struct Header {
    pub kind: String,
    pub big_endian: bool,
    pub fortran: bool,
    pub shape: Vec<usize>,
    /// The product of the shape.
    pub count: usize,
    /// All that comes before the numbers.
    pub bytes: u64,
}

impl Header {
    /// How long it is with all that is before it, given how the file begins.
    pub fn length(start: &[u8]) -> Result<u64, String> {
        let body = start
            .strip_prefix(b"\x93NUMPY")
            .ok_or("not a NumPy array (.npy)")?;
        match body {
            [1, _, a, b, ..] => Ok(10 + u64::from(u16::from_le_bytes([*a, *b]))),
            [2 | 3, _, a, b, c, d, ..] => Ok(12 + u64::from(u32::from_le_bytes([*a, *b, *c, *d]))),
            _ => Err("a NumPy file version that is not known".into()),
        }
    }

    /// Reads it where a file of `file_bytes` starts.
    pub fn parse(start: &[u8], file_bytes: u64) -> Result<Self, String> {
        let bytes = Self::length(start)?;
        let before = if start[6] == 1 { 10 } else { 12 };
        let text = usize::try_from(bytes)
            .ok()
            .and_then(|end| start.get(before..end))
            .ok_or("its header ends too early")?;
        let text = std::str::from_utf8(text).map_err(|_| "its header is not text")?;
        let after = |key: &str| {
            text.split_once(&format!("'{key}':"))
                .map(|(_, rest)| rest.trim_start())
                .ok_or(format!("its header has no '{key}'"))
        };
        let quoted = after("descr")?
            .strip_prefix('\'')
            .and_then(|rest| rest.split_once('\''));
        let descr = quoted
            .map(|(descr, _)| descr)
            .ok_or("structured arrays are not read")?;
        let kind = descr.trim_start_matches(['<', '>', '=', '|']).to_string();
        let order = after("fortran_order")?;
        let tuple = after("shape")?
            .strip_prefix('(')
            .and_then(|rest| rest.split_once(')'));
        let numbers = tuple
            .map(|(inside, _)| inside)
            .ok_or("its shape is not a tuple")?;
        let shape = numbers
            .split(',')
            .map(str::trim)
            .filter(|n| !n.is_empty())
            .map(str::parse)
            .collect::<Result<Vec<usize>, _>>();
        let shape =
            shape.map_err(|_| format!("its shape ({numbers}) is not made of whole numbers"))?;
        let size = match kind.as_str() {
            "f4" | "i4" => 4,
            "f8" | "i8" => 8,
            other => {
                return Err(format!(
                    "its type '{other}' is not read; use float32 or float64"
                ));
            }
        };
        let count = shape
            .iter()
            .try_fold(1usize, |product, &n| product.checked_mul(n));
        let data = file_bytes.saturating_sub(bytes);
        match count {
            Some(count) if count.checked_mul(size).map(|b| b as u64) == Some(data) => Ok(Self {
                kind,
                big_endian: descr.starts_with('>'),
                fortran: order.starts_with("True"),
                shape,
                count,
                bytes,
            }),
            _ => Err(format!(
                "its {data} bytes of data are not what shape {} needs",
                shape::tuple(&shape)
            )),
        }
    }
}
