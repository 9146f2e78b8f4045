//! Makes the scenes on which methods are known or suspected to break, the same bytes each time:
//!
//! `cargo run --release --example make_failure_scenes -- [FOLDER]`
//! : the small ones, their study and the table of their README, into `scenes/failures` if nothing
//! else is said.
//!
//! `cargo run --release --example make_failure_scenes -- large [FOLDER]`
//! : grass of 10⁵ blades and a forest of 1.8 million triangles with their study, into
//! `out/failures-large`.

mod case;
mod large;
mod light_cases;
mod material_cases;
mod meshes;
mod scale_cases;
mod shape_cases;

// What the scenes of the figures are made with; not all of it is needed here.
#[path = "../make_paper_scenes/chance.rs"]
mod chance;
#[path = "../make_paper_scenes/forest.rs"]
mod forest;
#[path = "../shared/mesh.rs"]
mod mesh;
#[allow(dead_code)] // made for more scenes than these
#[path = "../make_paper_scenes/shapes.rs"]
mod shapes;
#[allow(dead_code)] // made for more scenes than these
#[path = "../make_paper_scenes/xml.rs"]
mod xml;

use case::{Case, Study};
use std::error::Error;
use std::path::{Path, PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1).peekable();
    if arguments.next_if(|a| a == "large").is_some() {
        let folder = arguments.next().unwrap_or("out/failures-large".into());
        return large::write(&PathBuf::from(folder));
    }
    small(&PathBuf::from(
        arguments.next().unwrap_or("scenes/failures".into()),
    ))
}

fn small(folder: &Path) -> Result<(), Box<dyn Error>> {
    let mut cases: Vec<Case> = shape_cases::all();
    cases.extend(light_cases::all());
    cases.extend(material_cases::all());
    cases.extend(scale_cases::all());
    meshes::write(folder)?;
    let study = Study {
        title: "Stability: every method on the failure battery",
        about: "Small scenes on which published methods are known or suspected to break \
                (scenes/failures/README.md). `warpath study scenes/failures/study.toml --report \
                docs/stability.md` wrote this page; nothing here is typed by hand.",
        spp: "[64]",
        repeats: 24,
        reference_spp: 256,
        resolution: "16x16",
    };
    for case in &cases {
        std::fs::write(folder.join(format!("{}.xml", case.file)), case.scene())?;
    }
    std::fs::write(folder.join("study.toml"), study.toml(&cases))?;
    std::fs::write(folder.join("README.md"), case::readme(&cases))?;
    println!("{}: {} scenes", folder.display(), cases.len());
    Ok(())
}
