//! More samples, longer paths, more kinds of motion. `make test-long` runs it.

mod comparison;
mod leaves;
