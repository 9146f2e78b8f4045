//! Materials and textures as Mitsuba 3 XML.

use super::text::{escaped, joined, plain};
use crate::jobs::failure::Failure;
use crate::output::exr;
use crate::picture::Image;
use crate::scene::{Bsdf, Distribution, Layout, Microfacets, Relief, Scene, Wrap};
use glam::Affine2;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

/// What stands around a bsdf.
#[derive(Clone, Copy)]
enum Around {
    TwoSides,
    Relief(Relief),
}

/// Writes materials, each picture once.
pub struct Surfaces<'a> {
    scene: &'a Scene,
    folder: &'a Path,
    /// By texture, the file it is in.
    pictures: BTreeMap<usize, String>,
    /// Names of what was written, from the scene's file.
    pub files: Vec<String>,
}

impl<'a> Surfaces<'a> {
    pub fn new(scene: &'a Scene, folder: &'a Path) -> Self {
        Self {
            scene,
            folder,
            pictures: BTreeMap::new(),
            files: Vec::new(),
        }
    }

    /// A material, with an id if it stands in the scene itself.
    pub fn material(
        &mut self,
        m: usize,
        id: Option<&str>,
        indent: &str,
        text: &mut String,
    ) -> Result<(), Failure> {
        let material = &self.scene.materials[m];
        let id = id.map_or(String::new(), |id| format!(" id=\"{}\"", escaped(id)));
        let transmits = match material.bsdf {
            Bsdf::Dielectric { .. }
            | Bsdf::ThinDielectric { .. }
            | Bsdf::Null
            | Bsdf::Mask { .. } => true,
            Bsdf::Principled(p) => p.transmits,
            // What it is made of has two sides of its own.
            Bsdf::Blend { .. } => true,
            Bsdf::Diffuse { .. } | Bsdf::Conductor { .. } | Bsdf::Plastic { .. } => false,
        };
        // From the outside inward: what stands around the bsdf, each in the one before it.
        let mut around = Vec::new();
        if material.two_sided && !transmits {
            around.push(Around::TwoSides);
        }
        if let Some(relief) = material.relief {
            let at = match relief.is_mirrored {
                true => around.len(),
                false => 0,
            };
            around.insert(at, Around::Relief(relief));
        }
        self.wrapped(&around, material.bsdf, &id, indent, text)
    }

    fn wrapped(
        &mut self,
        around: &[Around],
        bsdf: Bsdf,
        id: &str,
        indent: &str,
        text: &mut String,
    ) -> Result<(), Failure> {
        let Some((first, rest)) = around.split_first() else {
            return self.bsdf(bsdf, id, indent, text);
        };
        let inner = format!("{indent}  ");
        match first {
            Around::TwoSides => {
                let _ = writeln!(text, "{indent}<bsdf type=\"twosided\"{id}>");
            }
            Around::Relief(relief) => match relief.bumps {
                Some(scale) => {
                    let _ = writeln!(text, "{indent}<bsdf type=\"bumpmap\"{id}>");
                    self.slot("nested_texture", relief.texture, &inner, text)?;
                    let _ = writeln!(text, "{inner}<float name=\"scale\" value=\"{scale}\"/>");
                }
                None => {
                    let _ = writeln!(text, "{indent}<bsdf type=\"normalmap\"{id}>");
                    self.slot("normalmap", relief.texture, &inner, text)?;
                }
            },
        }
        self.wrapped(rest, bsdf, "", &inner, text)?;
        let _ = writeln!(text, "{indent}</bsdf>");
        Ok(())
    }

    fn bsdf(
        &mut self,
        bsdf: Bsdf,
        id: &str,
        indent: &str,
        text: &mut String,
    ) -> Result<(), Failure> {
        let (plugin, microfacets) = match bsdf {
            Bsdf::Diffuse { .. } => ("diffuse", None),
            Bsdf::Conductor { microfacets, .. } => ("conductor", microfacets),
            Bsdf::Dielectric { microfacets, .. } => ("dielectric", microfacets),
            Bsdf::ThinDielectric { .. } => ("thindielectric", None),
            Bsdf::Plastic { microfacets, .. } => ("plastic", microfacets),
            Bsdf::Principled(_) => ("principled", None),
            Bsdf::Null => ("null", None),
            Bsdf::Mask { .. } => ("mask", None),
            Bsdf::Blend { .. } => ("blendbsdf", None),
        };
        let rough = if microfacets.is_some() { "rough" } else { "" };
        let _ = writeln!(text, "{indent}<bsdf type=\"{rough}{plugin}\"{id}>");
        let inner = format!("{indent}  ");
        if let Some(Microfacets { distribution, .. }) = microfacets {
            let name = match distribution {
                Distribution::Beckmann => "beckmann",
                Distribution::Ggx => "ggx",
            };
            let _ = writeln!(
                text,
                "{inner}<string name=\"distribution\" value=\"{name}\"/>"
            );
        }
        if let Bsdf::Plastic {
            nonlinear: true, ..
        } = bsdf
        {
            let _ = writeln!(text, "{inner}<boolean name=\"nonlinear\" value=\"true\"/>");
        }
        let has_indices = matches!(
            bsdf,
            Bsdf::Dielectric { .. } | Bsdf::ThinDielectric { .. } | Bsdf::Plastic { .. }
        );
        for (name, texture) in bsdf.slots() {
            match name == "eta" && has_indices {
                // Mitsuba takes the two indices of which it is the ratio.
                true => {
                    let eta = self.scene.constant(texture)[0];
                    let _ = writeln!(
                        text,
                        "{inner}<float name=\"int_ior\" value=\"{eta}\"/><float name=\"ext_ior\" value=\"1\"/>"
                    );
                }
                false => self.slot(name, texture, &inner, text)?,
            }
        }
        for (_, nested) in bsdf.nested() {
            self.material(nested, None, &inner, text)?;
        }
        let _ = writeln!(text, "{indent}</bsdf>");
        Ok(())
    }

    /// A colour or a number under a name.
    pub fn slot(
        &mut self,
        name: &str,
        t: usize,
        indent: &str,
        text: &mut String,
    ) -> Result<(), Failure> {
        let texture = &self.scene.textures[t];
        let value = |texel: usize| match texture.channels {
            1 => format!("float name=\"NAME\" value=\"{}\"", texture.texels[texel][0]),
            _ => format!(
                "rgb name=\"NAME\" value=\"{}\"",
                joined(&texture.texels[texel])
            ),
        };
        match texture.layout {
            Layout::Constant => {
                let _ = writeln!(text, "{indent}<{}/>", value(0).replace("NAME", name));
            }
            Layout::Vertices | Layout::Faces => {
                let attribute = escaped(texture.attribute().unwrap_or_default());
                let _ = writeln!(
                    text,
                    "{indent}<texture type=\"mesh_attribute\" name=\"{name}\"><string name=\"name\" \
                     value=\"{attribute}\"/></texture>"
                );
            }
            Layout::Checkerboard { to_uv } => {
                let colours = [0, 1].map(|number| {
                    let texel = texture.checkerboard_texel(number);
                    let name = format!("color{number}");
                    format!("<{}/>", value(texel).replace("NAME", &name))
                });
                let _ = writeln!(
                    text,
                    "{indent}<texture type=\"checkerboard\" name=\"{name}\">{}{}</texture>",
                    colours.concat(),
                    transform(to_uv)
                );
            }
            Layout::Bitmap {
                wrap,
                bilinear,
                to_uv,
                ..
            } => {
                let file = self.picture(t)?;
                let wrap = match wrap {
                    Wrap::Repeat => "repeat",
                    Wrap::Mirror => "mirror",
                    Wrap::Clamp => "clamp",
                };
                let filter = if bilinear { "bilinear" } else { "nearest" };
                let _ = writeln!(
                    text,
                    "{indent}<texture type=\"bitmap\" name=\"{name}\"><string name=\"filename\" value=\"{file}\"/>\
                     <boolean name=\"raw\" value=\"true\"/><string name=\"filter_type\" value=\"{filter}\"/><string \
                     name=\"wrap_mode\" value=\"{wrap}\"/>{}</texture>",
                    transform(to_uv)
                );
            }
        }
        Ok(())
    }

    /// Writes a bitmap as OpenEXR, once; its name from the scene's file.
    pub fn picture(&mut self, t: usize) -> Result<String, Failure> {
        if let Some(name) = self.pictures.get(&t) {
            return Ok(name.clone());
        }
        let texture = &self.scene.textures[t];
        let name = format!("scene/texture-{t:03}-{}.exr", plain(&texture.key));
        let file = Path::new(&name).file_name().unwrap_or_default();
        if let Some(image) = image(self.scene, t) {
            exr::write(&self.folder.join(file), &image)?;
        }
        self.files.push(name.clone());
        self.pictures.insert(t, name.clone());
        Ok(name)
    }
}

/// The texels of a bitmap as an image.
pub fn image(scene: &Scene, t: usize) -> Option<Image> {
    let texture = &scene.textures[t];
    match texture.layout {
        Layout::Bitmap { width, height, .. } => Some(Image {
            width: width as usize,
            height: height as usize,
            pixels: texture.texels.clone(),
        }),
        _ => None,
    }
}

fn transform(to_uv: Affine2) -> String {
    if to_uv == Affine2::IDENTITY {
        return String::new();
    }
    let [x, y, t] = [
        to_uv.matrix2.x_axis,
        to_uv.matrix2.y_axis,
        to_uv.translation,
    ];
    let rows = [
        x.x, y.x, 0.0, t.x, x.y, y.y, 0.0, t.y, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
    ];
    format!(
        "<transform name=\"to_uv\"><matrix value=\"{}\"/></transform>",
        joined(&rows)
    )
}
