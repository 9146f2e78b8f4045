//! `warpath study`: methods beside each other on many scenes, error against time.

pub mod bounds;
pub mod cell;
pub mod chart;
pub mod config;
mod figures;
pub mod journal;
mod measure;
mod one_run;
pub mod peers;
pub mod quantities;
pub mod reference;
pub mod report;
pub mod run;
mod task;
pub mod verdict;
