//! From XML text to the [`Tree`]: substitution, includes, references, with their limits.

use super::file::{File, folder_of, no_elements_inside, unknown_tag, utf8};
use super::limits::{self, MAX_DEPTH};
use super::plugins;
use super::properties::{Child, Object, Property, Tree};
use super::substitution::Substitutions;
use crate::scene::error::{Place, SceneError};
use crate::scene::nearest::shown;
use crate::scene::source::{FileSource, Fnv1a, read_file};
use roxmltree::{Document, Node, ParsingOptions};
use std::cell::Cell;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Files inside files, as in Mitsuba.
const MAX_INCLUDE_DEPTH: usize = 15;
/// Includes in all: two includes in each of 15 nested files would be 32 thousand.
const MAX_INCLUDES: usize = 1000;
/// Properties of one object: looking for a name twice among them is quadratic.
const MAX_PROPERTIES: usize = 256;
/// What editors leave behind between elements without showing it.
const INVISIBLE: [char; 2] = ['\u{200b}', '\u{feff}'];
/// XML nodes of one file.
const MAX_NODES: u32 = 4_000_000;

/// Reads the scene file `path` and what it includes.
///
/// What is not supported is refused, all of it at once; but if the scene is `to_list` it goes, with
/// warnings.
pub(in crate::scene) fn read_tree(
    files: &dyn FileSource,
    path: &Path,
    defines: &[(String, String)],
    hash: &mut Fnv1a,
    to_list: bool,
) -> Result<Tree, SceneError> {
    let mut reader = Reader {
        files,
        hash,
        substitutions: Substitutions::new(defines),
        tree: Tree {
            objects: Vec::new(),
            search_folders: Vec::new(),
            warnings: Vec::new(),
            scene_folder: folder_of(path),
        },
        ids: HashMap::new(),
        references: Vec::new(),
        unsupported: Vec::new(),
        open_files: Vec::new(),
        includes: 0,
    };
    reader.read_file(path, None, 0)?;
    let refused: Vec<String> = reader.unsupported.iter().map(Unsupported::shown).collect();
    if to_list {
        reader.tree.warnings.extend(refused);
    } else {
        let errors = reader.unsupported.iter();
        SceneError::all(errors.map(Unsupported::error).collect())?;
    }
    reader.resolve_references()?;
    if to_list {
        reader.tree.prune();
    }
    if let Some(what) = reader.substitutions.unused_define() {
        return Err(SceneError::Define { what });
    }
    Ok(reader.tree)
}

pub(super) struct Reader<'a> {
    pub(super) files: &'a dyn FileSource,
    pub(super) hash: &'a mut Fnv1a,
    pub(super) substitutions: Substitutions,
    pub(super) tree: Tree,
    /// Objects by id.
    pub(super) ids: HashMap<String, usize>,
    /// `<ref>` elements, resolved once everything is read: a reference may come before its object.
    pub(super) references: Vec<Reference>,
    unsupported: Vec<Unsupported>,
    /// The files being read, outermost first.
    open_files: Vec<PathBuf>,
    includes: usize,
}

/// Objects of a kind that is not supported.
struct Unsupported {
    /// Of the first.
    place: Place,
    what: String,
    /// How many more there are.
    more: usize,
}

impl Unsupported {
    fn error(&self) -> SceneError {
        let more = match self.more {
            0 => String::new(),
            more => format!(" (and {more} more of them)"),
        };
        SceneError::at(&self.place, format!("{}{more}", self.what))
    }

    fn shown(&self) -> String {
        self.error().to_string()
    }
}

pub(super) struct Reference {
    pub(super) parent: usize,
    /// Position among the parent's children.
    pub(super) position: usize,
    pub(super) id: String,
    pub(super) name: String,
    pub(super) place: Place,
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
        if let Some((at, what)) = limits::too_much(&file.text) {
            return Err(SceneError::at(&file.place_of_byte(at), what));
        }
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
            } else if child.is_text() {
                let text = child.text().unwrap_or_default();
                let text = text.trim_matches(|c: char| c.is_whitespace() || INVISIBLE.contains(&c));
                if !text.is_empty() {
                    let what = format!("stray text \"{}\" between elements", shown(text));
                    return Err(SceneError::at(&file.place(&child), what));
                }
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
            return Err(SceneError::at(&place, limits::nested_too_deep()));
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
        let refusal = plugins::check(tag, &plugin).err();
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
            is_supported: refusal.is_none(),
            id,
            place: place.clone(),
            folder: file.folder.clone(),
            properties: Vec::new(),
            children: Vec::new(),
        });
        match refusal {
            None => self.children(file, node, index, depth),
            Some(what) => {
                self.refuse(place, what);
                Ok(())
            }
        }
    }

    fn refuse(&mut self, place: Place, what: String) {
        match self.unsupported.iter_mut().find(|u| u.what == what) {
            Some(known) => known.more += 1,
            None => self.unsupported.push(Unsupported {
                place,
                what,
                more: 0,
            }),
        }
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
}
