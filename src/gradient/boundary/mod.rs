//! What moving boundaries bring.

mod backward;
mod forward;
