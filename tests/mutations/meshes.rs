//! Mesh files of few triangles, and mutations of them.

use super::extremes;
use super::random::Random;

/// How a mesh is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Format {
    Ascii,
    Little,
    Big,
    Obj,
}

impl Format {
    pub const ALL: [Self; 4] = [Self::Ascii, Self::Little, Self::Big, Self::Obj];

    pub fn plugin(self) -> &'static str {
        match self {
            Self::Obj => "obj",
            _ => "ply",
        }
    }
}

/// A mesh as a file holds it, right or wrong.
#[derive(Clone)]
pub struct MeshFile {
    format: Format,
    positions: Vec<[f64; 3]>,
    normals: Option<Vec<[f64; 3]>>,
    pub uvs: Option<Vec<[f64; 2]>>,
    faces: Vec<Vec<i64>>,
    /// What the header says of vertices and faces, if it lies.
    lies: [Option<String>; 2],
}

impl MeshFile {
    /// An octahedron, a tetrahedron or a strip of two triangles or of a square.
    pub fn draw(format: Format, random: &mut Random) -> Self {
        let (positions, faces): (Vec<[f64; 3]>, Vec<Vec<i64>>) = match random.below(4) {
            0 => (
                [
                    [1, 0, 0],
                    [-1, 0, 0],
                    [0, 1, 0],
                    [0, -1, 0],
                    [0, 0, 1],
                    [0, 0, -1],
                ]
                .map(|p| p.map(f64::from))
                .to_vec(),
                [
                    [0, 2, 4],
                    [2, 1, 4],
                    [1, 3, 4],
                    [3, 0, 4],
                    [2, 0, 5],
                    [1, 2, 5],
                    [3, 1, 5],
                    [0, 3, 5],
                ]
                .map(|f: [i64; 3]| f.to_vec())
                .to_vec(),
            ),
            1 => (
                vec![
                    [0.0, 0.0, 1.0],
                    [0.9, 0.0, -0.4],
                    [-0.5, 0.8, -0.4],
                    [-0.5, -0.8, -0.4],
                ],
                vec![vec![0, 1, 2], vec![0, 2, 3], vec![0, 3, 1], vec![1, 3, 2]],
            ),
            2 => (
                vec![
                    [-1.0, -1.0, 0.0],
                    [1.0, -1.0, 0.0],
                    [1.0, 1.0, 0.0],
                    [-1.0, 1.0, 0.5],
                ],
                vec![vec![0, 1, 2], vec![0, 2, 3]],
            ),
            _ => (
                vec![
                    [-1.0, -1.0, 0.0],
                    [1.0, -1.0, 0.0],
                    [1.0, 1.0, 0.0],
                    [-1.0, 1.0, 0.0],
                ],
                vec![vec![0, 1, 2, 3]],
            ),
        };
        let normals = random.chance(40).then(|| positions.clone());
        let uvs = positions
            .iter()
            .map(|p| [p[0] * 0.5 + 0.5, p[1] * 0.5 + 0.5]);
        let uvs = random.chance(60).then(|| uvs.collect());
        Self {
            format,
            positions,
            normals,
            uvs,
            faces,
            lies: [None, None],
        }
    }

    /// Changes something and says what.
    pub fn mutate(&mut self, random: &mut Random) -> String {
        let vertex = random.below(self.positions.len());
        let axis = random.below(3);
        match random.below(12) {
            0..3 => {
                let number = extremes::float(random);
                self.positions[vertex][axis] = number;
                format!("coordinate {axis} of vertex {vertex} is {number:e}")
            }
            3 => {
                let number = extremes::float(random);
                self.positions
                    .iter_mut()
                    .flatten()
                    .for_each(|x| *x *= number);
                format!("all positions times {number:e}")
            }
            4 => {
                let number = extremes::float(random);
                self.positions.iter_mut().for_each(|p| p[axis] += number);
                format!("coordinate {axis} of all positions plus {number:e}")
            }
            5 => {
                let to = self.positions[random.below(self.positions.len())];
                self.positions[vertex] = to;
                format!("vertex {vertex} is at {to:?}")
            }
            6 => {
                let number = extremes::float(random);
                self.normals.get_or_insert_with(|| self.positions.clone())[vertex] = [number; 3];
                format!("the normal of vertex {vertex} is three times {number:e}")
            }
            7 => {
                let number = extremes::float(random);
                let count = self.positions.len();
                self.uvs.get_or_insert_with(|| vec![[0.5; 2]; count])[vertex][axis % 2] = number;
                format!(
                    "texture coordinate {} of vertex {vertex} is {number:e}",
                    axis % 2
                )
            }
            8 => self.mutate_index(random),
            9 => self.mutate_faces(random),
            10 => {
                let lie = extremes::count(random);
                let which = random.below(2);
                self.lies[which] = Some(lie.clone());
                format!("the header says {lie:?} {}", ["vertices", "faces"][which])
            }
            _ => {
                let format = *random.pick(&Format::ALL);
                let is_same_plugin = format.plugin() == self.format.plugin();
                self.format = format;
                format!("written as {format:?}, which is right: {is_same_plugin}")
            }
        }
    }

    fn mutate_index(&mut self, random: &mut Random) -> String {
        let count = self.positions.len() as i64;
        let lies = [
            -1,
            -2,
            count,
            count + 1,
            0,
            255,
            65_536,
            0x7fff_ffff,
            0xffff_ffff,
        ];
        let lie = *random.pick(&lies);
        let Some(face) = self.faces.first_mut() else {
            return "nothing".into();
        };
        let at = random.below(face.len().max(1));
        if let Some(index) = face.get_mut(at) {
            *index = lie;
        }
        format!("index {at} of the first face is {lie}")
    }

    fn mutate_faces(&mut self, random: &mut Random) -> String {
        match random.below(5) {
            0 => {
                self.faces.clear();
                "no faces".into()
            }
            1 => {
                self.faces.extend(self.faces.clone());
                "all faces twice".into()
            }
            2 => {
                let size = *random.pick(&[0, 1, 2, 300]);
                self.faces.push((0..size).map(|i| i % 3).collect());
                format!("a face of {size} vertices")
            }
            3 => {
                self.positions.clear();
                self.positions.push([0.0; 3]);
                "one vertex".into()
            }
            _ => {
                self.faces.iter_mut().for_each(|face| face.fill(1));
                "all faces are a point".into()
            }
        }
    }

    pub fn encode(&self) -> Vec<u8> {
        match self.format {
            Format::Obj => self.obj().into_bytes(),
            _ => self.ply(),
        }
    }

    fn obj(&self) -> String {
        let mut out = String::new();
        let line = |tag: &str, numbers: &[f64]| {
            let numbers: Vec<String> = numbers.iter().map(|x| format!("{x:e}")).collect();
            format!("{tag} {}\n", numbers.join(" "))
        };
        self.positions.iter().for_each(|p| out += &line("v", p));
        let normals = self.normals.iter().flatten();
        normals.for_each(|n| out += &line("vn", n));
        self.uvs
            .iter()
            .flatten()
            .for_each(|t| out += &line("vt", t));
        for face in &self.faces {
            out += "f";
            for index in face {
                // Indices count from 1.
                let i = index + 1;
                out += &match (&self.uvs, &self.normals) {
                    (Some(_), Some(_)) => format!(" {i}/{i}/{i}"),
                    (Some(_), None) => format!(" {i}/{i}"),
                    (None, Some(_)) => format!(" {i}//{i}"),
                    (None, None) => format!(" {i}"),
                };
            }
            out += "\n";
        }
        out
    }

    fn ply(&self) -> Vec<u8> {
        let format = match self.format {
            Format::Little => "binary_little_endian",
            Format::Big => "binary_big_endian",
            _ => "ascii",
        };
        let count = |which: usize, true_count: usize| {
            let lie = self.lies[which].clone();
            lie.unwrap_or_else(|| true_count.to_string())
        };
        let mut header = format!(
            "ply\nformat {format} 1.0\ncomment small\nelement vertex {}\n",
            count(0, self.positions.len())
        );
        let properties = |names: &[&str]| {
            let lines = names.iter().map(|n| format!("property float {n}\n"));
            lines.collect::<String>()
        };
        header += &properties(&["x", "y", "z"]);
        if self.normals.is_some() {
            header += &properties(&["nx", "ny", "nz"]);
        }
        if self.uvs.is_some() {
            header += &properties(&["u", "v"]);
        }
        header += &format!(
            "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
            count(1, self.faces.len())
        );
        let mut out = header.into_bytes();
        for (i, p) in self.positions.iter().enumerate() {
            let mut numbers = p.to_vec();
            numbers.extend(self.normals.iter().filter_map(|n| n.get(i)).flatten());
            numbers.extend(self.uvs.iter().filter_map(|t| t.get(i)).flatten());
            self.vertex(&mut out, &numbers);
        }
        self.faces.iter().for_each(|face| self.face(&mut out, face));
        out
    }

    fn vertex(&self, out: &mut Vec<u8>, numbers: &[f64]) {
        match self.format {
            Format::Little => {
                let words = numbers.iter().map(|x| (*x as f32).to_le_bytes());
                out.extend(words.flatten());
            }
            Format::Big => {
                let words = numbers.iter().map(|x| (*x as f32).to_be_bytes());
                out.extend(words.flatten());
            }
            _ => {
                let words: Vec<String> = numbers.iter().map(|x| format!("{x:e}")).collect();
                out.extend((words.join(" ") + "\n").bytes());
            }
        }
    }

    fn face(&self, out: &mut Vec<u8>, face: &[i64]) {
        match self.format {
            Format::Little => {
                out.push(face.len() as u8);
                out.extend(face.iter().flat_map(|i| (*i as i32).to_le_bytes()));
            }
            Format::Big => {
                out.push(face.len() as u8);
                out.extend(face.iter().flat_map(|i| (*i as i32).to_be_bytes()));
            }
            _ => {
                let words: Vec<String> = face.iter().map(i64::to_string).collect();
                out.extend(format!("{} {}\n", face.len(), words.join(" ")).bytes());
            }
        }
    }
}
