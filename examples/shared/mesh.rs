//! Triangle meshes and their PLY files, for the examples that make scenes.

use std::io;
use std::path::Path;

pub type Point = [f64; 3];

#[derive(Default)]
pub struct Mesh {
    pub points: Vec<Point>,
    pub triangles: Vec<[usize; 3]>,
}

impl Mesh {
    /// The head of a PLY file of this mesh.
    pub fn header(&self, format: &str) -> String {
        format!(
            "ply\nformat {format} 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
             element face {}\nproperty list uchar int vertex_indices\nend_header\n",
            self.points.len(),
            self.triangles.len()
        )
    }

    pub fn write_binary(&self, path: &Path) -> io::Result<()> {
        let mut bytes = self.header("binary_little_endian").into_bytes();
        for x in self.points.iter().flatten() {
            bytes.extend((*x as f32).to_le_bytes());
        }
        for triangle in &self.triangles {
            bytes.push(3);
            for i in triangle {
                bytes.extend((*i as i32).to_le_bytes());
            }
        }
        std::fs::write(path, bytes)
    }
}
