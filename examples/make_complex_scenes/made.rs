//! A scene, its meshes and pictures, and how all of it gets into a folder.

use crate::mesh::Mesh;
use crate::xml::Scene;
use crate::{bands, bumps};
use std::error::Error;
use std::path::Path;

/// How many things a scene has.
#[derive(Clone, Copy)]
pub enum Density {
    Low,
    Middle,
    High,
}

impl Density {
    pub const ALL: [Self; 3] = [Self::Low, Self::Middle, Self::High];

    pub fn named(name: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|d| d.name() == name);
        found.ok_or_else(|| format!("no density is called {name}: low, middle or high"))
    }

    pub fn name(self) -> &'static str {
        self.of(["low", "middle", "high"])
    }

    /// The choice for this density.
    pub fn of<T: Copy>(self, choices: [T; 3]) -> T {
        choices[self as usize]
    }
}

pub struct Made {
    pub scene: Scene,
    /// By the names of their files, in world coordinates: the direction of bumps is evaluated at
    /// these points.
    pub meshes: Vec<(&'static str, Mesh)>,
    /// The mesh that may be bent.
    pub bent: &'static str,
    /// Whether a wall shows `bands.png`.
    pub bands: bool,
}

impl Made {
    /// Returns how many triangles the meshes have.
    pub fn write(&self, folder: &Path) -> Result<usize, Box<dyn Error>> {
        let meshes = folder.join("meshes");
        std::fs::create_dir_all(&meshes)?;
        for (name, mesh) in &self.meshes {
            mesh.write_binary(&meshes.join(format!("{name}.ply")))?;
            if *name == self.bent {
                bumps::write(&folder.join(format!("bumps_{name}.npy")), mesh)?;
            }
        }
        if self.bands {
            bands::write(&folder.join("bands.png"))?;
        }
        std::fs::write(
            folder.join(format!("{}.xml", self.scene.name)),
            self.scene.text(64),
        )?;
        Ok(self.meshes.iter().map(|(_, m)| m.triangles.len()).sum())
    }
}
