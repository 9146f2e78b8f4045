//! On what it was measured.

use crate::trace::{Accel, AccelOptions, Backend};
use serde::Serialize;
use std::collections::BTreeMap;

#[derive(Clone, Debug, Serialize)]
pub struct Machine {
    pub cpu: String,
    pub cores: usize,
    pub system: String,
    /// The vector instructions that this program was compiled for.
    pub instructions: Vec<&'static str>,
    /// Versions, by backend.
    pub libraries: BTreeMap<String, String>,
    /// Rays that each backend traces together.
    pub widths: BTreeMap<String, usize>,
}

impl Machine {
    pub fn here() -> Self {
        let cpus = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let cpu = cpus
            .lines()
            .find_map(|line| line.strip_prefix("model name"));
        let empty = |backend| Accel::build(&[], AccelOptions::default().on(backend)).ok();
        let accels: Vec<_> = Backend::built_in()
            .into_iter()
            .filter_map(|b| Some((b.to_string(), empty(b)?)))
            .collect();
        Self {
            cpu: cpu.map_or("unknown".into(), |name| {
                name.trim_start_matches([' ', '\t', ':']).into()
            }),
            cores: std::thread::available_parallelism().map_or(1, |n| n.get()),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            instructions: [
                ("sse2", cfg!(target_feature = "sse2")),
                ("sse4.2", cfg!(target_feature = "sse4.2")),
                ("avx", cfg!(target_feature = "avx")),
                ("avx2", cfg!(target_feature = "avx2")),
                ("fma", cfg!(target_feature = "fma")),
                ("avx512f", cfg!(target_feature = "avx512f")),
                ("neon", cfg!(target_feature = "neon")),
            ]
            .into_iter()
            .filter_map(|(name, is_on)| is_on.then_some(name))
            .collect(),
            libraries: accels
                .iter()
                .map(|(b, a)| (b.clone(), a.library_version()))
                .collect(),
            widths: accels
                .iter()
                .map(|(b, a)| (b.clone(), a.native_width()))
                .collect(),
        }
    }
}
