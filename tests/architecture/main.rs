//! What the sources are held to: who may use whom, where `unsafe` stays, how long things are,
//! what is cited.

mod foreign;
mod names;
mod order;
mod references;
mod sources;
