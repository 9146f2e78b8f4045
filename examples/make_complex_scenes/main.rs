//! Makes scenes of very many small or thin things, each in three densities, the same bytes each
//! time:
//!
//! `cargo run --release --example make_complex_scenes -- NAME DENSITY FOLDER`
//! : one of them, into `FOLDER/NAME-DENSITY`; the densities are `low`, `middle` and `high`.
//!
//! `cargo run --release --example make_complex_scenes -- all [FOLDER]`
//! : all of them, into `out/complex/scenes` if nothing else is said.

mod bands;
mod bumps;
mod lights;
mod made;
mod placing;
mod plants;
mod specks;
mod strips;

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

use made::{Density, Made};
use std::error::Error;
use std::path::{Path, PathBuf};

type Make = fn(Density) -> Made;

/// Every name, and what makes the scene. The forest is made elsewhere.
const FAMILY: [(&str, Make); 8] = [
    ("hedge", plants::hedge),
    ("grass", plants::grass),
    ("specks", specks::specks),
    ("specks_film", specks::specks_film),
    ("fence", strips::fence),
    ("fence_film", strips::fence_film),
    ("hair", strips::hair),
    ("lamp", lights::lamp),
];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match &arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["all"] => all(Path::new("out/complex/scenes")),
        ["all", folder] => all(Path::new(folder)),
        [name, density, folder] => one(name, Density::named(density)?, Path::new(folder)),
        _ => Err("what to make: NAME low|middle|high FOLDER, or all [FOLDER]".into()),
    }
}

fn all(folder: &Path) -> Result<(), Box<dyn Error>> {
    for density in Density::ALL {
        for (name, _) in FAMILY {
            one(name, density, folder)?;
        }
        one("forest", density, folder)?;
    }
    Ok(())
}

fn one(name: &str, density: Density, folder: &Path) -> Result<(), Box<dyn Error>> {
    let folder = folder.join(format!("{name}-{}", density.name()));
    let triangles = if name == "forest" {
        forest(density, &folder)?
    } else {
        let (_, make) = FAMILY
            .iter()
            .find(|(known, _)| *known == name)
            .ok_or_else(|| format!("no scene is called {name}"))?;
        make(density).write(&folder)?
    };
    let scene: PathBuf = folder.join(format!("{name}.xml"));
    println!("{}: {triangles} triangles", scene.display());
    Ok(())
}

/// The forest of the figures, with as many plants as the density leaves of it.
fn forest(density: Density, folder: &Path) -> Result<usize, Box<dyn Error>> {
    let star = shapes::star();
    let triangles = density.of([
        forest::TRIANGLES / 100,
        forest::TRIANGLES / 10,
        forest::TRIANGLES,
    ]);
    let made = forest::write(folder, triangles, &star)?;
    bumps::write(&folder.join("bumps_star.npy"), &star)?;
    Ok(made)
}
