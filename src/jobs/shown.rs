//! Numbers as people read them.

/// `12 MB`, `1.5 GB`.
pub fn bytes(count: u64) -> String {
    match count {
        b if b >= 10 << 30 => format!("{:.0} GB", b as f64 / f64::from(1 << 30)),
        b if b >= 1 << 30 => format!("{:.1} GB", b as f64 / f64::from(1 << 30)),
        b => format!("{} MB", b.div_ceil(1 << 20)),
    }
}

/// `1 sensor`, `2 sensors`.
pub fn counted(count: usize, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}
