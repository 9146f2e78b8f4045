//! Picture files of all kinds.

mod built_in;
#[cfg(feature = "oiio")]
mod oiio;
