//! Picture files of few pixels, and arrays of numbers, and mutations of both.

use super::extremes;
use super::random::Random;
use common::picture_files::{exr_rgb, float, half, hdr, jpeg, pfm, png8};

/// Names of pictures that scenes name; how they end says how they are written.
pub const PICTURES: [&str; 9] = [
    "c.png", "c.exr", "c.hdr", "c.pfm", "c.jpg", "grey.png", "sky.exr", "sky.hdr", "sky.pfm",
];

#[derive(Clone)]
pub struct PictureFile {
    name: String,
    size: [usize; 2],
    pixels: Vec<[f32; 3]>,
}

impl PictureFile {
    pub fn draw(name: &str, random: &mut Random) -> Self {
        // As much as an environment map must have.
        let size = [2 + random.below(5), 3 + random.below(3)];
        Self::of_size(name, size, random)
    }

    pub fn of_size(name: &str, size: [usize; 2], random: &mut Random) -> Self {
        let mut pixel = || [0; 3].map(|_| random.number(0.05, 0.95) as f32);
        Self {
            name: name.into(),
            size,
            pixels: (0..size[0] * size[1]).map(|_| pixel()).collect(),
        }
    }

    pub fn mutate(&mut self, random: &mut Random) -> String {
        let number = extremes::float(random) as f32;
        let at = random.below(self.pixels.len());
        match random.below(4) {
            0 => {
                self.pixels.fill([number; 3]);
                format!("all pixels are {number:e}")
            }
            1 => {
                self.size = [1, 1];
                self.pixels.truncate(1);
                "a single pixel".into()
            }
            _ => {
                self.pixels[at][random.below(3)] = number;
                format!("a number of pixel {at} is {number:e}")
            }
        }
    }

    pub fn encode(&self) -> Vec<u8> {
        let [width, height] = self.size;
        let bytes = || {
            let numbers = self.pixels.as_flattened().iter();
            numbers.map(|v| (v * 255.0) as u8).collect::<Vec<u8>>()
        };
        let ending = self.name.rsplit('.').next().unwrap_or_default();
        match ending {
            "png" if self.name.starts_with("grey") => {
                let grey: Vec<u8> = bytes().into_iter().step_by(3).collect();
                common::picture_files::png(
                    self.size.map(|n| n as u32),
                    png::ColorType::Grayscale,
                    png::BitDepth::Eight,
                    &grey,
                )
            }
            "png" => png8([width as u32, height as u32], &bytes()),
            "jpg" => {
                let size = [width as u16, height as u16];
                jpeg(size, &bytes(), image::ExtendedColorType::Rgb8)
            }
            "hdr" => hdr(self.size, &self.pixels),
            "pfm" => {
                let floats = self.pixels.as_flattened().iter().map(|v| v.to_le_bytes());
                pfm(&format!("PF\n{width} {height}\n-1.0\n"), floats)
            }
            _ if width % 2 == 0 => exr_rgb(self.size, &self.pixels, half),
            _ => exr_rgb(self.size, &self.pixels, float),
        }
    }
}

/// A `.npy` or `.safetensors` file.
#[derive(Clone)]
pub struct ArrayFile {
    /// The name of its tensor, if it is to be a `.safetensors`.
    tensor: Option<String>,
    kind: String,
    shape: String,
    values: Vec<f32>,
}

impl ArrayFile {
    pub fn draw(tensor: Option<&str>, shape: &[usize], random: &mut Random) -> Self {
        let count = shape.iter().product();
        Self {
            tensor: tensor.map(str::to_string),
            kind: if tensor.is_some() { "F32" } else { "<f4" }.into(),
            shape: shape.iter().map(|n| format!("{n},")).collect(),
            values: (0..count).map(|_| random.number(0.1, 0.9) as f32).collect(),
        }
    }

    pub fn mutate(&mut self, random: &mut Random) -> String {
        let number = extremes::float(random) as f32;
        match random.below(6) {
            0 => {
                let kinds = ["<f8", ">f4", "<i4", "<c8", "|O", "F16", "F64", "I64", ""];
                self.kind = random.pick(&kinds).to_string();
                format!("its type is {:?}", self.kind)
            }
            1 => {
                let shapes = [
                    "",
                    "0,",
                    "3,1,",
                    "1,3,",
                    "4294967296,4294967296,",
                    "-1,",
                    "1e9,",
                ];
                self.shape = random.pick(&shapes).to_string();
                format!("its shape is ({})", self.shape)
            }
            2 => {
                self.values.fill(number);
                format!("all numbers are {number:e}")
            }
            3 => {
                self.values.pop();
                "a number is missing".into()
            }
            _ => {
                let at = random.below(self.values.len().max(1));
                if let Some(value) = self.values.get_mut(at) {
                    *value = number;
                }
                format!("number {at} is {number:e}")
            }
        }
    }

    pub fn encode(&self) -> Vec<u8> {
        let data = self.values.iter().flat_map(|v| v.to_le_bytes());
        let mut out = Vec::new();
        match &self.tensor {
            Some(name) => {
                let header = format!(
                    r#"{{{}:{{"dtype":"{}","shape":[{}],"data_offsets":[0,{}]}}}}"#,
                    serde_json::Value::from(name.as_str()),
                    self.kind,
                    self.shape.trim_end_matches(','),
                    4 * self.values.len()
                );
                out.extend((header.len() as u64).to_le_bytes());
                out.extend(header.bytes());
            }
            None => {
                let header = format!(
                    "{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}\n",
                    self.kind, self.shape
                );
                out.extend(b"\x93NUMPY\x01\x00");
                out.extend((header.len() as u16).to_le_bytes());
                out.extend(header.bytes());
            }
        }
        out.extend(data);
        out
    }
}
