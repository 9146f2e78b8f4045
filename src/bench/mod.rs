//! Embree against obvhs: what `warpath bench` measures, and how it is told.

pub mod cases;
pub mod chart;
mod contestant;
mod machine;
mod measure;
pub mod meshes;
mod number;
pub mod rays;
mod run;
pub mod table;

pub use machine::Machine;
pub use measure::{Budget, Record};
pub use run::{Plan, measure, steps};

use serde::Serialize;

/// Everything a run found, as it stands in `bench.json`.
#[derive(Clone, Debug, Serialize)]
pub struct Results {
    pub version: &'static str,
    pub machine: Machine,
    /// Of each measurement, at least; see [`Budget`].
    pub seconds: f64,
    pub threads: usize,
    pub rays_per_pass: usize,
    pub packet_width: usize,
    pub records: Vec<Record>,
}

impl Results {
    /// Nothing yet.
    pub fn new(plan: Plan) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION"),
            machine: Machine::here(),
            seconds: plan.budget.seconds,
            threads: plan.threads,
            rays_per_pass: rays::RAYS,
            packet_width: crate::lanes::LANES,
            records: Vec::new(),
        }
    }

    /// The records of one case, backend and so on, if it was measured.
    pub fn find(&self, case: &str, what: &str, column: &Column, threads: usize) -> Option<&Record> {
        self.records.iter().find(|r| {
            r.case == case
                && r.what == what
                && r.backend == column.backend
                && r.robust == column.robust
                && r.threads == threads
        })
    }

    /// The cases, in the order they were measured.
    pub fn cases(&self) -> Vec<(String, usize)> {
        let mut cases: Vec<(String, usize)> = Vec::new();
        for r in &self.records {
            if cases.iter().all(|c| c.0 != r.case) {
                cases.push((r.case.clone(), r.triangles));
            }
        }
        cases
    }

    /// The backends at their usual presets, in the order they were measured.
    pub fn columns(&self) -> Vec<Column> {
        let mut columns: Vec<Column> = Vec::new();
        for r in self.records.iter().filter(|r| !r.backend.contains(':')) {
            let column = Column {
                backend: r.backend.clone(),
                robust: r.robust,
            };
            if !columns.contains(&column) {
                columns.push(column);
            }
        }
        columns
    }
}

/// A backend, robust or not.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    pub backend: String,
    pub robust: bool,
}

impl Column {
    /// As tables and charts name it.
    pub fn title(&self) -> String {
        let leaky = if self.robust { "" } else { ", leaky" };
        format!("{}{leaky}", self.backend)
    }
}
