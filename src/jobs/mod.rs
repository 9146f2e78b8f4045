//! What one run asks for: jobs as they are written, and what a scene and the machine make of them.

pub mod attachments;
pub mod direction;
pub mod failure;
pub mod id;
pub mod job;
pub mod machine;
pub mod numbers;
pub mod pairs;
pub mod request;
pub mod schema;
pub mod settings;
