//! Names and numbers as files have them.

/// Numbers with commas between.
pub fn joined(numbers: &[f32]) -> String {
    let shown: Vec<String> = numbers.iter().map(f32::to_string).collect();
    shown.join(", ")
}

/// As XML has it in an attribute.
pub fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '"' => out.push_str("&quot;"),
            c => out.push(c),
        }
    }
    out
}

/// A name of a file.
pub fn plain(id: &str) -> String {
    let keep = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    id.chars().take(60).map(keep).collect()
}
