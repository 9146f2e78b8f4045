//! What one run asks for: jobs as they are written, and what a scene and the machine make of them.

pub mod attachments;
pub mod check;
pub mod config;
pub mod define;
pub mod direction;
pub mod failure;
pub mod id;
pub mod job;
pub mod machine;
pub mod mode;
pub mod number_file;
pub mod numbers;
pub mod numbers_json;
pub mod pairs;
pub mod pictures;
pub mod read;
pub mod request;
pub mod resolution;
pub mod results;
pub mod schema;
pub mod seeds;
pub mod settings;
pub mod shown;
