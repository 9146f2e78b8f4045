//! Objects of the scene file with typed properties, which remember whether they were read.

use crate::scene::error::{Place, SceneError};
use crate::scene::nearest::{mistyped, nearest_hint, shown};
use crate::scene::spectrum::{Of, Spectrum};
use glam::{DAffine3, DVec3};
use std::cell::Cell;
use std::path::PathBuf;
use std::sync::Arc;

/// Light of one unit at all wavelengths, in linear sRGB, as Mitsuba's RGB mode converts it.
const EQUAL_ENERGY_SRGB: [f64; 3] = [1.204_793_9, 0.948_291, 0.908_916_06];

/// All objects of a scene file and of what it includes; the root is object 0.
#[derive(Debug)]
pub(in crate::scene) struct Tree {
    /// In the order of the file.
    pub objects: Vec<Object>,
    /// Folders of `<path>` elements, the latest first.
    pub search_folders: Vec<PathBuf>,
    /// Of what stands in the file.
    pub warnings: Vec<String>,
    /// The folder of the scene file.
    pub scene_folder: PathBuf,
}

impl Tree {
    /// Whether an object, or something inside it, is not supported: only when parameters are
    /// listed.
    pub fn lacks_support(&self, object: usize) -> bool {
        let object = &self.objects[object];
        let mut children = object.children.iter();
        !object.is_supported || children.any(|c| self.lacks_support(c.object))
    }

    /// Takes out what is not supported, but bsdfs, whose places are known to the shapes.
    pub fn prune(&mut self) {
        let goes: Vec<bool> = self
            .objects
            .iter()
            .map(|o| !o.is_supported && o.tag != "bsdf")
            .collect();
        for object in &mut self.objects {
            object.children.retain(|c| !goes[c.object]);
        }
    }
}

/// An element that makes a plugin: `<shape type="ply" id="…">`.
#[derive(Debug)]
pub(in crate::scene) struct Object {
    /// `shape`, `bsdf`, …
    pub tag: &'static str,
    /// `ply`, `diffuse`, …
    pub plugin: String,
    /// Others are empty, and only there when a scene's parameters are listed.
    pub is_supported: bool,
    pub id: Option<String>,
    pub place: Place,
    /// Folder of the file that the element is in.
    pub folder: Arc<PathBuf>,
    pub properties: Vec<Property>,
    pub children: Vec<Child>,
}

/// An object inside another one, in place or by `<ref>`.
#[derive(Debug)]
pub(in crate::scene) struct Child {
    /// The `name` attribute; often empty.
    pub name: String,
    /// Index into [`Tree::objects`].
    pub object: usize,
    /// Of the element or of the `<ref>`.
    pub place: Place,
}

#[derive(Debug)]
pub(in crate::scene) struct Property {
    pub name: String,
    pub value: Value,
    pub place: Place,
    /// Someone asked for it, so it has an effect.
    pub read: Cell<bool>,
}

#[derive(Clone, Debug, PartialEq)]
pub(in crate::scene) enum Value {
    Boolean(bool),
    Integer(i64),
    Float(f64),
    String(String),
    /// `rgb` and `srgb`, linear.
    Rgb([f64; 3]),
    /// A `spectrum` of one value at all wavelengths.
    Grey(f64),
    /// A `spectrum` by wavelength.
    Spectrum(Spectrum),
    Vector(DVec3),
    Transform(DAffine3),
}

impl Value {
    fn kind(&self) -> &'static str {
        match self {
            Value::Boolean(_) => "boolean",
            Value::Integer(_) => "integer",
            Value::Float(_) => "float",
            Value::String(_) => "string",
            Value::Rgb(_) => "rgb",
            Value::Grey(_) | Value::Spectrum(_) => "spectrum",
            Value::Vector(_) => "point or vector",
            Value::Transform(_) => "transform",
        }
    }
}

impl Object {
    /// `<shape type="ply">`
    pub fn shown(&self) -> String {
        format!("<{} type=\"{}\">", self.tag, self.plugin)
    }

    /// An error at this object.
    pub fn error(&self, what: impl Into<String>) -> SceneError {
        SceneError::at(&self.place, what)
    }

    /// An error at a property if it is there, else at the object.
    pub fn property_error(&self, name: &str, what: impl Into<String>) -> SceneError {
        let property = self.properties.iter().find(|p| p.name == name);
        SceneError::at(property.map_or(&self.place, |p| &p.place), what)
    }

    /// Whether the file gives this property. Does not count as reading it.
    pub fn has(&self, name: &str) -> bool {
        self.properties.iter().any(|p| p.name == name)
    }

    /// The property, marked as read, if the file gives it.
    pub fn property(&self, name: &str) -> Option<&Property> {
        let property = self.properties.iter().find(|p| p.name == name)?;
        property.read.set(true);
        Some(property)
    }

    fn get<T>(
        &self,
        name: &str,
        wanted: &str,
        convert: impl Fn(&Value) -> Option<T>,
    ) -> Result<Option<T>, SceneError> {
        let Some(property) = self.property(name) else {
            return Ok(None);
        };
        convert(&property.value).map(Some).ok_or_else(|| {
            let what = format!(
                "property \"{name}\" of {} must be a <{wanted}>, not a <{}>",
                self.shown(),
                property.value.kind()
            );
            SceneError::at(&property.place, what)
        })
    }

    pub fn boolean(&self, name: &str, default: bool) -> Result<bool, SceneError> {
        let value = self.get(name, "boolean", |v| match v {
            Value::Boolean(b) => Some(*b),
            _ => None,
        })?;
        Ok(value.unwrap_or(default))
    }

    pub fn integer(&self, name: &str) -> Result<Option<i64>, SceneError> {
        self.get(name, "integer", |v| match v {
            Value::Integer(i) => Some(*i),
            _ => None,
        })
    }

    /// An integer between `least` and the largest `u32`.
    pub fn count(&self, name: &str, default: u32, least: u32) -> Result<u32, SceneError> {
        let Some(value) = self.integer(name)? else {
            return Ok(default);
        };
        match u32::try_from(value) {
            Ok(v) if v >= least => Ok(v),
            _ => Err(self.property_error(
                name,
                format!(
                    "\"{name}\" must be an integer from {least} to {}, not {value}",
                    u32::MAX
                ),
            )),
        }
    }

    /// A float; an integer will do.
    pub fn float(&self, name: &str) -> Result<Option<f64>, SceneError> {
        self.get(name, "float", |v| match v {
            Value::Float(f) => Some(*f),
            Value::Integer(i) => Some(*i as f64),
            _ => None,
        })
    }

    /// A float greater than zero.
    pub fn positive(&self, name: &str, default: f64) -> Result<f64, SceneError> {
        match self.float(name)? {
            None => Ok(default),
            Some(v) if v as f32 > 0.0 => Ok(v),
            Some(v) => {
                let what = format!("\"{name}\" must be greater than zero, not {v}");
                Err(self.property_error(name, what))
            }
        }
    }

    pub fn string(&self, name: &str) -> Result<Option<String>, SceneError> {
        self.get(name, "string", |v| match v {
            Value::String(s) => Some(s.clone()),
            _ => None,
        })
    }

    /// A string out of `allowed`, compared without case.
    pub fn choice(
        &self,
        name: &str,
        default: &'static str,
        allowed: &[&'static str],
    ) -> Result<&'static str, SceneError> {
        let Some(text) = self.string(name)? else {
            return Ok(default);
        };
        let found = allowed.iter().find(|a| a.eq_ignore_ascii_case(&text));
        found.copied().ok_or_else(|| {
            let what = format!(
                "\"{name}\" cannot be \"{}\"{}; it is one of {}",
                shown(&text),
                nearest_hint(&text, allowed.iter().copied()),
                allowed.join(", ")
            );
            self.property_error(name, what)
        })
    }

    pub fn vector(&self, name: &str) -> Result<Option<DVec3>, SceneError> {
        self.get(name, "point", |v| match v {
            Value::Vector(v) => Some(*v),
            _ => None,
        })
    }

    pub fn transform(&self, name: &str) -> Result<DAffine3, SceneError> {
        let value = self.get(name, "transform", |v| match v {
            Value::Transform(t) => Some(*t),
            _ => None,
        })?;
        Ok(value.unwrap_or(DAffine3::IDENTITY))
    }

    /// A colour without a texture: `rgb`, `srgb`, a plain `spectrum` or a `float`. A plain
    /// `spectrum` of an emitter has equal energy at all wavelengths, of which the colour is not
    /// grey.
    pub fn colour(&self, name: &str) -> Result<Option<[f64; 3]>, SceneError> {
        self.get(name, "rgb", |v| match v {
            Value::Rgb(c) => Some(*c),
            Value::Spectrum(s) => Some(s.srgb(match name {
                _ if self.tag == "emitter" => Of::Emission,
                "eta" | "k" => Of::Index,
                _ => Of::Reflectance,
            })),
            Value::Grey(g) if self.tag == "emitter" => Some(EQUAL_ENERGY_SRGB.map(|c| c * g)),
            Value::Grey(g) | Value::Float(g) => Some([*g; 3]),
            Value::Integer(i) => Some([*i as f64; 3]),
            _ => None,
        })
    }

    /// A number that may also be written as a grey `spectrum`, or as a colour, whose mean is taken.
    pub fn number(&self, name: &str) -> Result<Option<f64>, SceneError> {
        self.get(name, "float", |v| match v {
            Value::Float(f) | Value::Grey(f) => Some(*f),
            Value::Rgb([r, g, b]) => Some((r + g + b) / 3.0),
            Value::Integer(i) => Some(*i as f64),
            _ => None,
        })
    }

    /// Whether the property is a string. Does not count as reading it.
    pub fn holds_string(&self, name: &str) -> bool {
        let mut properties = self.properties.iter();
        properties.any(|p| p.name == name && matches!(p.value, Value::String(_)))
    }

    /// A warning for every property that nothing read. `known` are names that the plugin reads.
    pub fn unread(&self, known: &[&str]) -> Vec<String> {
        let unread = self.properties.iter().filter(|p| !p.read.get());
        unread
            .map(|p| {
                let hint = match mistyped(&p.name, known.iter().copied()) {
                    Some(near) if near != p.name => {
                        format!("; the nearest one it reads is \"{near}\"")
                    }
                    _ => String::new(),
                };
                format!(
                    "{}: property \"{}\" of {} was not read{hint}",
                    p.place,
                    shown(&p.name),
                    self.shown()
                )
            })
            .collect()
    }
}
