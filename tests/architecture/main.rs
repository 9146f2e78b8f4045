//! What the sources are held to: who may use whom, where `unsafe` stays, how long things are,
//! what is cited.

mod circles;
mod dimensions;
mod foreign;
mod lengths;
mod names;
mod order;
mod reasons;
mod references;
mod sources;
