//! From XML text to the [`Tree`]: substitution, includes, references, with their limits.

use super::plugins;
use super::properties::{Child, Object, Property, Tree, Value};
use super::substitution::Substitutions;
use super::{transform, values};
use crate::scene::error::{Place, SceneError};
use crate::scene::nearest::{nearest_hint, shown};
use crate::scene::source::{FileSource, Fnv1a, read_file};
use glam::DAffine3;
use roxmltree::{Document, Node, ParsingOptions};
use std::cell::Cell;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Elements inside elements, counted through includes.
const MAX_DEPTH: usize = 64;
/// Files inside files, as in Mitsuba.
const MAX_INCLUDE_DEPTH: usize = 15;
/// Includes in all: two includes in each of 15 nested files would be 32 thousand.
const MAX_INCLUDES: usize = 1000;
/// Properties of one object: looking for a name twice among them is quadratic.
const MAX_PROPERTIES: usize = 256;
/// XML nodes of one file.
const MAX_NODES: u32 = 4_000_000;

/// Reads the scene file `path` and what it includes.
pub(in crate::scene) fn read_tree(
    files: &dyn FileSource,
    path: &Path,
    defines: &[(String, String)],
    hash: &mut Fnv1a,
) -> Result<Tree, SceneError> {
    let mut reader = Reader {
        files,
        hash,
        substitutions: Substitutions::new(defines),
        tree: Tree {
            objects: Vec::new(),
            search_folders: Vec::new(),
            scene_folder: folder_of(path),
        },
        ids: HashMap::new(),
        references: Vec::new(),
        open_files: Vec::new(),
        includes: 0,
    };
    reader.read_file(path, None, 0)?;
    reader.resolve_references()?;
    if let Some(what) = reader.substitutions.unused_define() {
        return Err(SceneError::Define { what });
    }
    Ok(reader.tree)
}

struct Reader<'a> {
    files: &'a dyn FileSource,
    hash: &'a mut Fnv1a,
    substitutions: Substitutions,
    tree: Tree,
    /// Objects by id.
    ids: HashMap<String, usize>,
    /// `<ref>` elements, resolved once everything is read: a reference may come before its object.
    references: Vec<Reference>,
    /// The files being read, outermost first.
    open_files: Vec<PathBuf>,
    includes: usize,
}

struct Reference {
    parent: usize,
    /// Position among the parent's children.
    position: usize,
    id: String,
    name: String,
    place: Place,
}

/// One file while its elements are read.
struct File {
    name: Arc<str>,
    folder: Arc<PathBuf>,
    line_starts: Vec<usize>,
    text: String,
}

/// The attributes of an element after substitution.
struct Attributes(Vec<(String, String)>);

impl Attributes {
    fn get(&self, name: &str) -> Option<String> {
        let found = self.0.iter().find(|(n, _)| n == name);
        found.map(|(_, value)| value.clone())
    }

    /// Present: checked by `expect`.
    fn text(&self, name: &str) -> String {
        self.get(name).unwrap_or_default()
    }
}

fn folder_of(path: &Path) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).to_path_buf()
}

impl File {
    fn new(path: &Path, text: String) -> Self {
        let after_newlines = text.match_indices('\n').map(|(at, _)| at + 1);
        Self {
            name: path.display().to_string().into(),
            folder: Arc::new(folder_of(path)),
            line_starts: std::iter::once(0).chain(after_newlines).collect(),
            text,
        }
    }

    fn place(&self, node: &Node) -> Place {
        let at = node.range().start;
        let line = self.line_starts.partition_point(|&start| start <= at);
        let start = self.line_starts[line - 1];
        Place {
            file: self.name.clone(),
            line: line as u32,
            column: self.text[start..at].chars().count() as u32 + 1,
        }
    }
}

impl Reader<'_> {
    fn read_file(
        &mut self,
        path: &Path,
        parent: Option<usize>,
        depth: usize,
    ) -> Result<(), SceneError> {
        let bytes = read_file(self.files, path)?;
        let file = File::new(path, utf8(path, bytes)?);
        let options = ParsingOptions {
            nodes_limit: MAX_NODES,
            ..Default::default()
        };
        let document = Document::parse_with_options(&file.text, options).map_err(|e| {
            let place = Place {
                file: file.name.clone(),
                line: e.pos().row,
                column: e.pos().col,
            };
            // The parser's sentence ends with its own "at line:column".
            let sentence = e.to_string();
            let position = format!(" at {}:{}", e.pos().row, e.pos().col);
            let sentence = sentence.strip_suffix(&position).unwrap_or(&sentence);
            SceneError::at(&place, format!("not well-formed XML: {}", shown(sentence)))
        })?;
        self.open_files.push(self.files.canonical(path));
        self.root(&file, document.root_element(), parent, depth)?;
        self.open_files.pop();
        Ok(())
    }

    fn root(
        &mut self,
        file: &File,
        node: Node,
        parent: Option<usize>,
        depth: usize,
    ) -> Result<(), SceneError> {
        let place = file.place(&node);
        let tag = node.tag_name().name();
        match node.attribute("version") {
            None => {
                let what = format!(
                    "the root element <{}> has no version; write version=\"3.0.0\"",
                    shown(tag)
                );
                return Err(SceneError::at(&place, what));
            }
            Some(version) => {
                let major = version
                    .split('.')
                    .next()
                    .and_then(|v| v.parse::<u32>().ok());
                if !matches!(major, Some(2 | 3)) {
                    let what = format!(
                        "scene version \"{}\" is not supported: it is 2 or 3, as in version=\"3.0.0\"",
                        shown(version)
                    );
                    return Err(SceneError::at(&place, what));
                }
            }
        }
        match (parent, tag) {
            (None, "scene") => self.object(file, node, None, depth),
            (None, _) => {
                let what = format!(
                    "the root element of a scene is <scene>, not <{}>",
                    shown(tag)
                );
                Err(SceneError::at(&place, what))
            }
            // An included scene brings what is in it.
            (Some(parent), "scene") => {
                self.attributes(file, node, &["version"], &["id", "name", "type"])?;
                self.children(file, node, parent, depth)
            }
            (Some(parent), _) => self.element(file, node, parent, depth),
        }
    }

    fn children(
        &mut self,
        file: &File,
        node: Node,
        parent: usize,
        depth: usize,
    ) -> Result<(), SceneError> {
        for child in node.children() {
            if child.is_element() {
                self.element(file, child, parent, depth + 1)?;
            } else if child.is_text() && !child.text().unwrap_or_default().trim().is_empty() {
                let what = format!(
                    "stray text \"{}\" between elements",
                    shown(child.text().unwrap_or_default().trim())
                );
                return Err(SceneError::at(&file.place(&child), what));
            }
        }
        Ok(())
    }

    fn element(
        &mut self,
        file: &File,
        node: Node,
        parent: usize,
        depth: usize,
    ) -> Result<(), SceneError> {
        let tag = node.tag_name().name();
        let place = file.place(&node);
        if depth > MAX_DEPTH {
            let what = format!("elements are nested more than {MAX_DEPTH} deep");
            return Err(SceneError::at(&place, what));
        }
        // <spectrum type="…"> is a plugin, <spectrum value="…"> a property.
        let is_spectrum_property = tag == "spectrum" && !node.has_attribute("type");
        if plugins::object_tag(tag).is_some() && !is_spectrum_property {
            return self.object(file, node, Some(parent), depth);
        }
        match tag {
            "default" => {
                let a = self.attributes(file, node, &["name", "value"], &[])?;
                if a.text("name").is_empty() {
                    return Err(SceneError::at(&place, "<default> has an empty name"));
                }
                self.substitutions
                    .set_default(&a.text("name"), &a.text("value"));
            }
            "path" => {
                let a = self.attributes(file, node, &["value"], &[])?;
                if parent != 0 {
                    let what = "<path> can only stand directly inside <scene>";
                    return Err(SceneError::at(&place, what));
                }
                let folder = file.folder.join(a.text("value"));
                self.tree.search_folders.insert(0, folder);
            }
            "include" => return self.include(file, node, parent, depth),
            "ref" => {
                let a = self.attributes(file, node, &["id"], &["name"])?;
                let children = &mut self.tree.objects[parent].children;
                self.references.push(Reference {
                    parent,
                    position: children.len(),
                    id: a.text("id"),
                    name: a.text("name"),
                    place: place.clone(),
                });
                // A placeholder: `resolve_references` fills in the object.
                children.push(Child {
                    name: a.text("name"),
                    object: parent,
                    place,
                });
            }
            _ => {
                let (name, value) = self.property(file, node)?;
                let owner = &mut self.tree.objects[parent];
                if let Some(first) = owner.properties.iter().find(|p| p.name == name) {
                    let what = format!(
                        "property \"{}\" was already given at {}",
                        shown(&name),
                        first.place
                    );
                    return Err(SceneError::at(&place, what));
                }
                if owner.properties.len() >= MAX_PROPERTIES {
                    let what = format!("an object has more than {MAX_PROPERTIES} properties");
                    return Err(SceneError::at(&place, what));
                }
                let read = Cell::new(false);
                owner.properties.push(Property {
                    name,
                    value,
                    place,
                    read,
                });
                return no_elements_inside(file, node, tag);
            }
        }
        no_elements_inside(file, node, tag)
    }

    fn object(
        &mut self,
        file: &File,
        node: Node,
        parent: Option<usize>,
        depth: usize,
    ) -> Result<(), SceneError> {
        let place = file.place(&node);
        let written_tag = node.tag_name().name();
        let Some(tag) = plugins::object_tag(written_tag) else {
            return Err(unknown_tag(&place, written_tag));
        };
        let is_scene = tag == "scene";
        if is_scene && parent.is_some() {
            return Err(SceneError::at(
                &place,
                "<scene> can only be the root element",
            ));
        }
        let required: &[&str] = if is_scene { &["version"] } else { &["type"] };
        // The root of an included file carries a version.
        let a = self.attributes(file, node, required, &["type", "id", "name", "version"])?;
        let plugin = a.get("type").unwrap_or_else(|| "scene".to_string());
        plugins::check(tag, &plugin).map_err(|what| SceneError::at(&place, what))?;
        let index = self.tree.objects.len();
        let id = a.get("id").filter(|id| !id.is_empty());
        if let Some(id) = &id
            && let Some(first) = self.ids.insert(id.clone(), index)
        {
            let what = format!(
                "duplicate id \"{}\"; the first is at {}",
                shown(id),
                self.tree.objects[first].place
            );
            return Err(SceneError::at(&place, what));
        }
        if let Some(parent) = parent {
            self.tree.objects[parent].children.push(Child {
                name: a.text("name"),
                object: index,
                place: place.clone(),
            });
        }
        self.tree.objects.push(Object {
            tag,
            plugin,
            id,
            place,
            folder: file.folder.clone(),
            properties: Vec::new(),
            children: Vec::new(),
        });
        self.children(file, node, index, depth)
    }

    fn property(&mut self, file: &File, node: Node) -> Result<(String, Value), SceneError> {
        let tag = node.tag_name().name();
        let place = file.place(&node);
        let simple = ["boolean", "integer", "float", "string", "rgb", "srgb"];
        let a = match tag {
            "transform" => {
                let a = self.attributes(file, node, &["name"], &[])?;
                return Ok((
                    a.text("name"),
                    Value::Transform(self.transform(file, node)?),
                ));
            }
            "point" | "vector" => {
                self.attributes(file, node, &["name"], &["value", "x", "y", "z"])?
            }
            "spectrum" => self.attributes(file, node, &["name"], &["value", "filename"])?,
            _ if simple.contains(&tag) => self.attributes(file, node, &["name", "value"], &[])?,
            "translate" | "rotate" | "scale" | "lookat" | "matrix" => {
                let what = format!("<{tag}> can only stand inside <transform>");
                return Err(SceneError::at(&place, what));
            }
            _ => return Err(unknown_tag(&place, tag)),
        };
        let text = a.text("value");
        let value = match tag {
            "boolean" => values::boolean(&text).map(Value::Boolean),
            "integer" => values::integer(&text).map(Value::Integer),
            "float" => values::number(&text).map(Value::Float),
            "string" => Ok(Value::String(text)),
            "rgb" => values::rgb(&text).map(Value::Rgb),
            "srgb" => values::srgb(&text).map(Value::Rgb),
            "spectrum" => match a.get("filename") {
                Some(_) => Err("spectra from files are not supported; use <rgb>".to_string()),
                None => values::number(&text).map(Value::Grey).map_err(|e| {
                    format!("{e}; only a plain number (grey) is supported here, or use <rgb>")
                }),
            },
            _ => transform::xyz(&|name| a.get(name), 0.0).map(Value::Vector),
        };
        let value = value.map_err(|e| SceneError::at(&place, format!("<{tag}>: {e}")))?;
        Ok((a.text("name"), value))
    }

    fn transform(&mut self, file: &File, node: Node) -> Result<DAffine3, SceneError> {
        let mut whole = DAffine3::IDENTITY;
        for child in node.children().filter(Node::is_element) {
            let tag = child.tag_name().name();
            let place = file.place(&child);
            let (required, optional): (&[&str], &[&str]) = match tag {
                "translate" | "scale" => (&[], &["value", "x", "y", "z"]),
                "rotate" => (&["angle"], &["value", "x", "y", "z"]),
                "lookat" => (&["origin", "target"], &["up"]),
                "matrix" => (&["value"], &[]),
                _ => {
                    let known = ["translate", "rotate", "scale", "lookat", "matrix"];
                    let what = format!(
                        "<{}> cannot stand inside <transform>{}",
                        shown(tag),
                        nearest_hint(tag, known)
                    );
                    return Err(SceneError::at(&place, what));
                }
            };
            let a = self.attributes(file, child, required, optional)?;
            let operation = transform::operation(tag, &|name| a.get(name));
            let operation =
                operation.map_err(|e| SceneError::at(&place, format!("<{tag}>: {e}")))?;
            whole = operation * whole;
            if !whole.as_affine3a().is_finite() {
                return Err(SceneError::at(&place, "the transform is no longer finite"));
            }
            no_elements_inside(file, child, tag)?;
        }
        Ok(whole)
    }

    fn include(
        &mut self,
        file: &File,
        node: Node,
        parent: usize,
        depth: usize,
    ) -> Result<(), SceneError> {
        let place = file.place(&node);
        let a = self.attributes(file, node, &["filename"], &["name"])?;
        no_elements_inside(file, node, "include")?;
        let path = self
            .tree
            .find_file(self.files, &file.folder, &a.text("filename"))
            .map_err(|what| SceneError::at(&place, what))?;
        let canonical = self.files.canonical(&path);
        self.includes += 1;
        let refusal = if self.open_files.contains(&canonical) {
            Some(format!("{} includes itself", path.display()))
        } else if self.open_files.len() > MAX_INCLUDE_DEPTH {
            Some(format!(
                "files include files more than {MAX_INCLUDE_DEPTH} deep"
            ))
        } else if self.includes > MAX_INCLUDES {
            Some(format!("more than {MAX_INCLUDES} includes"))
        } else {
            None
        };
        match refusal {
            Some(what) => Err(SceneError::at(&place, what)),
            None => self.read_file(&path, Some(parent), depth + 1),
        }
    }

    /// Substitutes in all attributes and checks their names.
    fn attributes(
        &mut self,
        file: &File,
        node: Node,
        required: &[&str],
        optional: &[&str],
    ) -> Result<Attributes, SceneError> {
        let place = file.place(&node);
        let tag = node.tag_name().name();
        self.hash.write(tag.as_bytes());
        let mut out = Vec::new();
        for attribute in node.attributes() {
            let name = attribute.name();
            let known = required.iter().chain(optional).copied();
            if !known.clone().any(|k| k == name) {
                let what = format!(
                    "<{}> has no attribute \"{}\"{}",
                    shown(tag),
                    shown(name),
                    nearest_hint(name, known)
                );
                return Err(SceneError::at(&place, what));
            }
            let value = self.substitutions.substitute(attribute.value());
            let value = value.map_err(|e| SceneError::at(&place, e))?;
            for part in [name, &value] {
                self.hash.write(part.as_bytes());
                self.hash.write(&[0]);
            }
            out.push((name.to_string(), value));
        }
        for name in required {
            if !out.iter().any(|(n, _)| n == name) {
                let what = format!("<{}> lacks the attribute \"{name}\"", shown(tag));
                return Err(SceneError::at(&place, what));
            }
        }
        Ok(Attributes(out))
    }

    fn resolve_references(&mut self) -> Result<(), SceneError> {
        for reference in &self.references {
            let Some(&target) = self.ids.get(&reference.id) else {
                let what = format!(
                    "no object has the id \"{}\"{}",
                    shown(&reference.id),
                    nearest_hint(&reference.id, self.ids.keys().map(String::as_str))
                );
                return Err(SceneError::at(&reference.place, what));
            };
            let child = &mut self.tree.objects[reference.parent].children[reference.position];
            child.object = target;
            child.name.clone_from(&reference.name);
        }
        self.refuse_cycles()
    }

    /// An object that contains itself would never be finished. Objects in place are younger than what they
    /// are in, so every cycle goes through a reference.
    fn refuse_cycles(&self) -> Result<(), SceneError> {
        #[derive(Clone, Copy, PartialEq)]
        enum State {
            New,
            Open,
            Done,
        }
        let mut states = vec![State::New; self.tree.objects.len()];
        // (object, next child to visit): an explicit stack, for chains of references can be long.
        let mut stack = vec![(0, 0)];
        while let Some((object, next)) = stack.pop() {
            states[object] = State::Open;
            let Some(child) = self.tree.objects[object].children.get(next) else {
                states[object] = State::Done;
                continue;
            };
            stack.push((object, next + 1));
            match states[child.object] {
                State::New => stack.push((child.object, 0)),
                State::Done => {}
                State::Open => {
                    let what = "the reference makes the object contain itself";
                    return Err(SceneError::at(&child.place, what));
                }
            }
        }
        Ok(())
    }
}

impl Tree {
    /// The path of a file named in an element of a file in `folder`; the error is a sentence.
    pub fn find_file(
        &self,
        files: &dyn FileSource,
        folder: &Path,
        name: &str,
    ) -> Result<PathBuf, String> {
        if name.is_empty() {
            return Err("the file name is empty".to_string());
        }
        let folders = self.search_folders.iter().map(PathBuf::as_path);
        let folders = folders.chain([folder, &self.scene_folder]);
        // Joining an absolute path gives that path.
        let mut tried = folders.map(|f| f.join(name));
        tried.find(|path| files.exists(path)).ok_or_else(|| {
            format!(
                "file \"{}\" is not there (looked in {}{})",
                shown(name),
                if folder.as_os_str().is_empty() {
                    "."
                } else {
                    ""
                },
                folder.display()
            )
        })
    }
}

fn utf8(path: &Path, bytes: Vec<u8>) -> Result<String, SceneError> {
    String::from_utf8(bytes).map_err(|e| {
        let good = &e.as_bytes()[..e.utf8_error().valid_up_to()];
        let line_start = good
            .iter()
            .rposition(|&b| b == b'\n')
            .map_or(0, |at| at + 1);
        let place = Place {
            file: path.display().to_string().into(),
            line: good.iter().filter(|&&b| b == b'\n').count() as u32 + 1,
            column: String::from_utf8_lossy(&good[line_start..]).chars().count() as u32 + 1,
        };
        SceneError::at(&place, "the file is not UTF-8 text")
    })
}

fn unknown_tag(place: &Place, tag: &str) -> SceneError {
    let hint = nearest_hint(tag, plugins::all_tags());
    SceneError::at(place, format!("unknown element <{}>{hint}", shown(tag)))
}

fn no_elements_inside(file: &File, node: Node, tag: &str) -> Result<(), SceneError> {
    if tag == "transform" {
        return Ok(());
    }
    match node.children().find(Node::is_element) {
        None => Ok(()),
        Some(child) => {
            let inner = shown(child.tag_name().name());
            let what = format!("<{inner}> cannot stand inside <{}>", shown(tag));
            Err(SceneError::at(&file.place(&child), what))
        }
    }
}
