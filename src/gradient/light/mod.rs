//! What light brings to a vertex, differentiated.

mod backward;
mod delta_backward;
mod delta_forward;
mod forward;
