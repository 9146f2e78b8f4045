//! Whether a JPEG file is whole: the decoder fills what is missing with grey and says nothing.

const START_OF_SCAN: u8 = 0xda;
const END_OF_IMAGE: u8 = 0xd9;

/// Whether the marker that ends the image is there. It must be walked to, segment by segment: the
/// thumbnail inside another segment ends with the same two bytes.
pub(super) fn is_whole(bytes: &[u8]) -> bool {
    // After the marker that starts the image.
    let mut at = 2;
    while let Some((marker, after)) = next_marker(bytes, at) {
        match marker {
            END_OF_IMAGE => return true,
            // These stand alone.
            0x01 | 0xd0..=0xd8 => at = after,
            _ => {
                let Some(&[high, low]) = bytes.get(after..after + 2) else {
                    return false;
                };
                at = after + usize::from(u16::from_be_bytes([high, low]));
                if marker == START_OF_SCAN {
                    at = end_of_scan(bytes, at);
                }
            }
        }
    }
    false
}

/// The next marker from `at` on, and where its segment goes on.
fn next_marker(bytes: &[u8], at: usize) -> Option<(u8, usize)> {
    let from = at + bytes.get(at..)?.iter().position(|b| *b == 0xff)?;
    // Any number of fill bytes may come before a marker.
    let marker = from + bytes[from..].iter().position(|b| *b != 0xff)?;
    Some((bytes[marker], marker + 1))
}

/// Where the coded data from `at` on ends: at a marker other than those that restart it.
fn end_of_scan(bytes: &[u8], at: usize) -> usize {
    let coded = bytes.get(at..).unwrap_or_default();
    let is_end = |pair: &[u8]| pair[0] == 0xff && !matches!(pair[1], 0 | 0xff | 0xd0..=0xd7);
    let length = coded.windows(2).position(is_end);
    at + length.unwrap_or(coded.len())
}
