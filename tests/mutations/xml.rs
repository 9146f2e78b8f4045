//! Mutations of scene files that leave them well-formed.

use super::element::Element;
use super::extremes;
use super::random::Random;
use super::scenes::SceneFiles;

/// What costs time or memory in proportion: a large value would be honoured.
const COSTLY: [&str; 7] = [
    "sample_count",
    "width",
    "height",
    "crop_width",
    "crop_height",
    "max_depth",
    "rr_depth",
];

/// Plugins in place of others.
const PLUGINS: [&str; 24] = [
    "diffuse",
    "conductor",
    "roughconductor",
    "dielectric",
    "roughdielectric",
    "plastic",
    "roughplastic",
    "null",
    "twosided",
    "area",
    "constant",
    "envmap",
    "point",
    "directional",
    "bitmap",
    "checkerboard",
    "cube",
    "rectangle",
    "ply",
    "obj",
    "box",
    "tent",
    "gaussian",
    "nonsense",
];

const TAGS: [&str; 14] = [
    "float", "integer", "rgb", "srgb", "spectrum", "string", "boolean", "point", "vector", "ref",
    "bsdf", "texture", "emitter", "default",
];

const PROPERTIES: [&str; 22] = [
    "alpha",
    "eta",
    "k",
    "int_ior",
    "ext_ior",
    "reflectance",
    "specular_reflectance",
    "specular_transmittance",
    "diffuse_reflectance",
    "radiance",
    "color0",
    "color1",
    "intensity",
    "irradiance",
    "scale",
    "fov",
    "near_clip",
    "far_clip",
    "principal_point_offset_x",
    "stddev",
    "radius",
    "position",
];

const OPERATIONS: [&str; 5] = [
    r#"<scale value="1"/>"#,
    r#"<translate x="1"/>"#,
    r#"<rotate x="1" y="1" angle="30"/>"#,
    r#"<matrix value="1 0.2 0 0 0 1 0 0 0 0 1 0 0 0 0 1"/>"#,
    r#"<lookat origin="0, -4, 2" target="0, 0, 0" up="0, 0, 1"/>"#,
];

/// Changes an element of the scene, or of what it includes, and says what.
pub fn mutate(scene: &mut SceneFiles, random: &mut Random) -> String {
    let tree = match &mut scene.part {
        Some(part) if random.chance(50) => part,
        _ => &mut scene.xml,
    };
    match random.below(20) {
        0..11 => number(tree, random),
        11 => plugin(tree, random),
        12 => {
            let element = any(tree, random);
            let before = element.shown();
            let property = random.pick(&PROPERTIES).to_string();
            replace(element, "name", property);
            format!("{before} becomes {}", element.shown())
        }
        13 => attribute(tree, random),
        14 => {
            let copy = any(tree, random).clone();
            let parent = any(tree, random);
            let what = format!("{} also in {}", copy.shown(), parent.shown());
            let at = random.below(parent.children.len() + 1);
            parent.children.insert(at, copy);
            what
        }
        15 | 16 => drop_child(tree, random),
        17 => {
            let element = any(tree, random);
            let before = element.shown();
            element.tag = random.pick(&TAGS).to_string();
            format!("{before} becomes {}", element.shown())
        }
        18 => {
            let operation = Element::parse(random.word(&OPERATIONS));
            let what = operation.tag.clone();
            let (owner, transform) = transform(tree, random);
            let at = random.below(transform.children.len() + 1);
            transform.children.insert(at, operation);
            format!("{what} inserted in the transform of {owner}")
        }
        _ => add_property(tree, random),
    }
}

fn any<'a>(tree: &'a mut Element, random: &mut Random) -> &'a mut Element {
    let n = random.below(tree.count());
    tree.nth(n)
}

fn replace(element: &mut Element, name: &str, value: String) {
    match element.attributes.iter_mut().find(|(n, _)| n == name) {
        Some((_, old)) => *old = value,
        None => element.attributes.push((name.into(), value)),
    }
}

/// One number somewhere, or all of one attribute, becomes an extreme one.
fn number(tree: &mut Element, random: &mut Random) -> String {
    let holds_number = |(name, value): &(String, String)| {
        let known = ["value", "x", "y", "z", "angle", "origin", "target", "up"];
        known.contains(&name.as_str()) && value.bytes().any(|b| b.is_ascii_digit())
    };
    let count = tree.count();
    let with_numbers: Vec<usize> = (0..count)
        .filter(|n| tree.nth(*n).attributes.iter().any(holds_number))
        .collect();
    if with_numbers.is_empty() {
        return attribute(tree, random);
    }
    // What things are made of and where they are stands beside many settings.
    let is_physical = |tree: &mut Element, n: &usize| {
        let element = tree.nth(*n);
        let is_known = element
            .attribute("name")
            .is_some_and(|n| PROPERTIES.contains(&n));
        is_known || ["translate", "scale", "matrix", "default"].contains(&element.tag.as_str())
    };
    let mut n = *random.pick(&with_numbers);
    for _ in 0..3 {
        if !is_physical(tree, &n) && random.chance(70) {
            n = *random.pick(&with_numbers);
        }
    }
    let element = tree.nth(n);
    let shown = element.shown();
    let is_costly = element
        .attribute("name")
        .is_some_and(|n| COSTLY.contains(&n));
    let attributes = element.attributes.iter_mut().filter(|a| holds_number(a));
    let mut attributes: Vec<_> = attributes.collect();
    let which = random.below(attributes.len());
    let (name, value) = &mut attributes[which];
    let parts: Vec<&str> = value.split(',').collect();
    let at = random.below(parts.len());
    let number: Result<f64, _> = parts[at].trim().parse();
    let is_share = number.is_ok_and(|x| (0.0..=1.0).contains(&x));
    // Most of what is beyond 0 and 1 is refused where numbers are between them.
    let new = match (is_costly, is_share && random.chance(70)) {
        (true, _) => extremes::count(random),
        (false, true) => extremes::share(random),
        (false, false) => extremes::number(random),
    };
    let whole = random.chance(30);
    let parts = parts.iter().enumerate();
    let changed: Vec<&str> = parts
        .map(|(i, part)| if whole || i == at { &new } else { *part })
        .collect();
    let before = std::mem::replace(value, changed.join(","));
    format!("{shown} {name}=\"{before}\" becomes \"{value}\"")
}

fn plugin(tree: &mut Element, random: &mut Random) -> String {
    let count = tree.count();
    let plugins: Vec<usize> = (0..count)
        .filter(|n| tree.nth(*n).attribute("type").is_some())
        .collect();
    if plugins.is_empty() {
        return drop_child(tree, random);
    }
    let n = *random.pick(&plugins);
    let element = tree.nth(n);
    let before = element.shown();
    replace(element, "type", random.pick(&PLUGINS).to_string());
    format!("{before} becomes {}", element.shown())
}

/// An attribute is dropped, renamed, emptied, or gets another's value.
fn attribute(tree: &mut Element, random: &mut Random) -> String {
    let other = any(tree, random).attributes.first().cloned();
    let element = any(tree, random);
    let shown = element.shown();
    if element.attributes.is_empty() {
        element.attributes.push(("name".into(), "x".into()));
        return format!("{shown} gets a name");
    }
    let at = random.below(element.attributes.len());
    let name = element.attributes[at].0.clone();
    match random.below(5) {
        0 => {
            element.attributes.remove(at);
            format!("{shown} loses {name}")
        }
        1 => {
            let word = extremes::word(random);
            element.attributes[at].1 = word.into();
            format!("{name} of {shown} is {word:?}")
        }
        2 => {
            let new = *random.pick(&["x", "y", "id", "angel", "value", "filename"]);
            if element.attribute(new).is_some() {
                return "nothing".into();
            }
            element.attributes[at].0 = new.into();
            format!("{name} of {shown} is called {new}")
        }
        3 => {
            let (_, value) = other.unwrap_or_default();
            let what = format!("{name} of {shown} is {value:?}");
            element.attributes[at].1 = value;
            what
        }
        _ => {
            element.attributes[at].1 = match element.attributes[at].1.as_str() {
                "true" => "false".into(),
                "false" => "true".into(),
                _ => "$far".into(),
            };
            format!("{name} of {shown} is {:?}", element.attributes[at].1)
        }
    }
}

fn drop_child(tree: &mut Element, random: &mut Random) -> String {
    let count = tree.count();
    let parents: Vec<usize> = (0..count)
        .filter(|n| !tree.nth(*n).children.is_empty())
        .collect();
    if parents.is_empty() {
        return "nothing".into();
    }
    let n = *random.pick(&parents);
    let parent = tree.nth(n);
    let at = random.below(parent.children.len());
    // Without its film an image has half a million pixels.
    if parent.children[at].tag == "film" {
        return "nothing".into();
    }
    let child = parent.children.remove(at);
    if random.chance(60) {
        return format!("{} left out", child.shown());
    }
    let elsewhere = any(tree, random);
    let what = format!("{} moves to {}", child.shown(), elsewhere.shown());
    elsewhere.children.push(child);
    what
}

/// A transform that is there, or a new one of a shape.
fn transform<'a>(tree: &'a mut Element, random: &mut Random) -> (String, &'a mut Element) {
    let count = tree.count();
    let owners: Vec<usize> = (0..count)
        .filter(|n| ["shape", "sensor", "texture"].contains(&tree.nth(*n).tag.as_str()))
        .collect();
    let n = if owners.is_empty() {
        0
    } else {
        *random.pick(&owners)
    };
    let owner = tree.nth(n);
    let shown = owner.shown();
    let name = if owner.tag == "texture" {
        "to_uv"
    } else {
        "to_world"
    };
    let at = owner.children.iter().position(|c| c.tag == "transform");
    let at = at.unwrap_or_else(|| {
        let new = Element::parse(&format!(r#"<transform name="{name}"/>"#));
        owner.children.push(new);
        owner.children.len() - 1
    });
    (shown, &mut owner.children[at])
}

fn add_property(tree: &mut Element, random: &mut Random) -> String {
    let count = tree.count();
    let objects: Vec<usize> = (0..count)
        .filter(|n| tree.nth(*n).attribute("type").is_some())
        .collect();
    if objects.is_empty() {
        return "nothing".into();
    }
    let n = *random.pick(&objects);
    let object = tree.nth(n);
    let tag = random.pick(&["float", "rgb", "spectrum", "integer"]);
    let name = random.pick(&PROPERTIES);
    let value = extremes::number(random);
    let text = format!(r#"<{tag} name="{name}" value="{value}"/>"#);
    let what = format!("{} gets {text}", object.shown());
    object.children.push(Element::parse(&text));
    what
}
