//! Damage to a file of any kind.

use super::random::Random;

/// Words that stand in the headers of files, and what they may lie instead.
const LIES: [u32; 10] = [
    0,
    1,
    2,
    7,
    255,
    65_535,
    65_537,
    0x7fff_ffff,
    0xffff_ffff,
    0x1000_0000,
];

/// Changes `bytes` and says how.
pub fn damage(bytes: &mut Vec<u8>, random: &mut Random) -> String {
    if bytes.is_empty() {
        bytes.push(random.next() as u8);
        return "a byte".into();
    }
    let at = random.below(bytes.len());
    match random.below(8) {
        0 => {
            bytes.truncate(at);
            format!("cut off at {at}")
        }
        1 => {
            bytes[at] ^= 1 << random.below(8);
            format!("a bit of byte {at}")
        }
        2 => {
            bytes[at] = random.next() as u8;
            format!("byte {at}")
        }
        // Most that a reader relies on stands first.
        3 => header_lie(bytes, random),
        4 => ascii_number(bytes, random),
        5 => {
            let length = 1 + random.below(16).min(bytes.len() - at - 1);
            bytes.drain(at..at + length.min(bytes.len() - at));
            format!("{length} bytes from {at} left out")
        }
        6 => {
            let length = (1 + random.below(64)).min(bytes.len() - at);
            let copy = bytes[at..at + length].to_vec();
            let to = random.below(bytes.len());
            bytes.splice(to..to, copy);
            format!("{length} bytes from {at} again at {to}")
        }
        _ => {
            let extra = 1 + random.below(32);
            bytes.extend((0..extra).map(|_| random.next() as u8));
            format!("{extra} bytes more")
        }
    }
}

/// Four bytes among the first 400 become another integer.
fn header_lie(bytes: &mut [u8], random: &mut Random) -> String {
    if bytes.len() < 8 {
        bytes[0] = 0;
        return "byte 0".into();
    }
    let at = random.below((bytes.len() - 4).min(400));
    let lie = *random.pick(&LIES);
    let word = match random.chance(50) {
        true => lie.to_le_bytes(),
        false => lie.to_be_bytes(),
    };
    bytes[at..at + 4].copy_from_slice(&word);
    format!("the word at {at} is {word:?}")
}

/// A run of digits becomes another number.
fn ascii_number(bytes: &mut Vec<u8>, random: &mut Random) -> String {
    let is_start =
        |i: &usize| bytes[*i].is_ascii_digit() && (*i == 0 || !bytes[*i - 1].is_ascii_digit());
    let starts: Vec<usize> = (0..bytes.len().min(4000)).filter(is_start).collect();
    if starts.is_empty() {
        bytes.clear();
        return "emptied".into();
    }
    let start = *random.pick(&starts);
    let digits = bytes[start..].iter().take_while(|b| b.is_ascii_digit());
    let end = start + digits.count();
    let new = match random.chance(50) {
        true => super::extremes::count(random),
        false => super::extremes::number(random),
    };
    bytes.splice(start..end, new.bytes());
    format!("the number at {start} is {new:?}")
}
