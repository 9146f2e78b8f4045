//! What moving boundaries bring.

mod backward;
mod chain;
mod forward;
