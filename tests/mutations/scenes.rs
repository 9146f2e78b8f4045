//! Small scenes that together hold everything the program reads.

use super::element::Element;
use super::materials::{colour, lights, material};
use super::meshes::{Format, MeshFile};
use super::pictures::{PICTURES, PictureFile};
use super::random::Random;
use std::collections::BTreeMap;

/// A scene file and what it names.
#[derive(Clone)]
pub struct SceneFiles {
    pub xml: Element,
    /// A part of it that it includes, as `part.xml`.
    pub part: Option<Element>,
    pub meshes: BTreeMap<String, MeshFile>,
    pub pictures: BTreeMap<String, PictureFile>,
    /// Of the image of the first sensor.
    pub size: [usize; 2],
}

impl SceneFiles {
    pub fn draw(random: &mut Random) -> Self {
        let film = [4 + random.below(5), 4 + random.below(5)];
        let is_cropped = random.chance(25);
        let mut meshes = BTreeMap::new();
        let shapes = shapes(&mut meshes, random);
        let text = format!(
            r#"<scene version="3.0.0"><default name="far" value="100"/><default name="bright" value="3"/>
            {}{}{shapes}{}</scene>"#,
            integrator(random),
            sensors(film, is_cropped, random),
            lights(random)
        );
        let named = |name: &str| text.contains(&format!("\"{name}\""));
        let pictures = PICTURES.iter().filter(|name| named(name));
        let pictures = pictures
            .map(|name| (name.to_string(), PictureFile::draw(name, random)))
            .collect();
        let mut xml = Element::parse(&text);
        let part = random.chance(15).then(|| split(&mut xml));
        Self {
            xml,
            part,
            meshes,
            pictures,
            size: if is_cropped { CROPPED } else { film },
        }
    }

    /// Whether there are sharp edges that `reparam` does not find: it refuses what moves then.
    pub fn is_sharp(&self) -> bool {
        let text = self.xml.text() + &self.part.as_ref().map_or(String::new(), Element::text);
        let sharp = [
            "conductor",
            "dielectric",
            "plastic",
            "null",
            "point",
            "directional",
        ];
        sharp
            .iter()
            .any(|plugin| text.contains(&format!("type=\"{plugin}\"")))
    }

    /// All files.
    pub fn files(&self) -> BTreeMap<String, Vec<u8>> {
        let mut files = BTreeMap::new();
        files.insert("s.xml".to_string(), self.xml.text().into_bytes());
        if let Some(part) = &self.part {
            files.insert("part.xml".to_string(), part.text().into_bytes());
        }
        for (name, mesh) in &self.meshes {
            files.insert(name.clone(), mesh.encode());
        }
        for (name, picture) in &self.pictures {
            files.insert(name.clone(), picture.encode());
        }
        files
    }
}

/// Puts the last object of the scene into a file that is included.
fn split(xml: &mut Element) -> Element {
    let last = xml.children.pop();
    let mut part = Element::parse(r#"<scene version="3.0.0"/>"#);
    part.children.extend(last);
    xml.children
        .push(Element::parse(r#"<include filename="part.xml"/>"#));
    part
}

fn integrator(random: &mut Random) -> String {
    let plugin = *random.pick(&["path", "path", "path", "direct", "prb", "prb_reparam"]);
    if plugin == "direct" {
        return r#"<integrator type="direct"/>"#.into();
    }
    format!(
        r#"<integrator type="{plugin}"><integer name="max_depth" value="{}"/>
        <integer name="rr_depth" value="{}"/><boolean name="hide_emitters" value="{}"/></integrator>"#,
        random.pick(&["1", "2", "3", "4", "-1"]),
        random.pick(&["1", "3", "5"]),
        random.chance(20)
    )
}

/// The window of a cropped film.
const CROPPED: [usize; 2] = [3, 2];

fn sensors(film: [usize; 2], is_cropped: bool, random: &mut Random) -> String {
    let first = sensor("cam", film, is_cropped, random);
    match random.chance(15) {
        true => first + &sensor("second", [5, 4], false, random),
        false => first,
    }
}

fn sensor(id: &str, [width, height]: [usize; 2], is_cropped: bool, random: &mut Random) -> String {
    let filter = random.pick(&[
        r#"<rfilter type="box"/>"#,
        r#"<rfilter type="tent"/>"#,
        r#"<rfilter type="tent"><float name="radius" value="1.5"/></rfilter>"#,
        r#"<rfilter type="gaussian"/>"#,
        r#"<rfilter type="gaussian"><float name="stddev" value="0.7"/></rfilter>"#,
        "",
    ]);
    let crop = match is_cropped {
        true => {
            r#"<integer name="crop_width" value="3"/><integer name="crop_height" value="2"/>
            <integer name="crop_offset_x" value="1"/><integer name="crop_offset_y" value="1"/>"#
        }
        false => "",
    };
    let axis = random.pick(&["x", "y", "diagonal", "smaller", "larger"]);
    let off_centre = random.pick(&[
        "",
        "",
        r#"<float name="principal_point_offset_x" value="0.1"/><float name="principal_point_offset_y" value="-0.05"/>"#,
    ]);
    let sampler = random.pick(&["independent", "stratified", "multijitter", "ldsampler"]);
    format!(
        r#"<sensor type="perspective" id="{id}"><float name="fov" value="{}"/><string name="fov_axis" value="{axis}"/>
        <float name="near_clip" value="0.01"/><float name="far_clip" value="$far"/>{off_centre}
        <transform name="to_world"><lookat origin="0.3, -4, 2" target="0, 0, 0.4" up="0, 0, 1"/></transform>
        <sampler type="{sampler}"><integer name="sample_count" value="{}"/><integer name="seed" value="3"/></sampler>
        <film type="hdrfilm"><integer name="width" value="{width}"/><integer name="height" value="{height}"/>{crop}{filter}
        <boolean name="sample_border" value="{}"/></film></sensor>"#,
        random.number(30.0, 60.0),
        random.pick(&["1", "2", "4", "5"]),
        random.chance(20)
    )
}

/// A floor, one or two things over it, and often a lamp.
fn shapes(meshes: &mut BTreeMap<String, MeshFile>, random: &mut Random) -> String {
    let shared = random.chance(15);
    let mut out = String::new();
    if shared {
        let bsdf = material(false, random);
        out += &bsdf.replacen("<bsdf ", r#"<bsdf id="paint" "#, 1);
    }
    out += &format!(
        r#"<shape type="rectangle" id="floor"><transform name="to_world"><scale value="2"/></transform>{}</shape>"#,
        material(true, random)
    );
    for id in ["thing", "other"].iter().take(1 + random.below(2)) {
        let bsdf = |textured, random: &mut Random| match shared && random.chance(50) {
            true => r#"<ref id="paint"/>"#.to_string(),
            false => material(textured, random),
        };
        out += &thing(id, meshes, bsdf, random);
    }
    if random.chance(60) {
        let radiance = match random.chance(50) {
            true => r#"<rgb name="radiance" value="$bright, 5, 4"/>"#.into(),
            false => colour("radiance", true, random),
        };
        out += &format!(
            r#"<shape type="rectangle" id="lamp"><transform name="to_world"><rotate x="1" angle="180"/><scale value="0.5"/>
            <translate z="2.2"/></transform><emitter type="area">{radiance}</emitter></shape>"#
        );
    }
    out
}

fn thing(
    id: &str,
    meshes: &mut BTreeMap<String, MeshFile>,
    bsdf: impl Fn(bool, &mut Random) -> String,
    random: &mut Random,
) -> String {
    let placed = format!(
        r#"<transform name="to_world"><scale value="0.5"/><rotate z="1" y="0.3" angle="{}"/><translate x="{}" y="{}" z="{}"/></transform>"#,
        random.number(0.0, 90.0),
        random.number(-0.6, 0.6),
        random.number(-0.6, 0.6),
        random.number(0.3, 0.9)
    );
    let flags = random.pick(&[
        "",
        "",
        r#"<boolean name="face_normals" value="true"/>"#,
        r#"<boolean name="flip_normals" value="true"/>"#,
    ]);
    let kind = random.below(20);
    if kind == 0 {
        // Some 20 thousand triangles: seldom.
        return format!(
            r#"<shape type="sphere" id="{id}"><point name="center" x="0" y="0" z="0.5"/><float name="radius" value="0.5"/>
            {flags}{}</shape>"#,
            bsdf(false, random)
        );
    }
    if kind < 6 {
        let plugin = random.pick(&["cube", "rectangle"]);
        let bsdf = bsdf(true, random);
        return format!(r#"<shape type="{plugin}" id="{id}">{placed}{flags}{bsdf}</shape>"#);
    }
    let format = *random.pick(&Format::ALL);
    let mesh = MeshFile::draw(format, random);
    let bsdf = bsdf(mesh.uvs.is_some(), random);
    let plugin = format.plugin();
    let file = format!("{id}.{plugin}");
    let emitter = match random.chance(15) {
        true => r#"<emitter type="area"><rgb name="radiance" value="2, 1, 1"/></emitter>"#,
        false => "",
    };
    meshes.insert(file.clone(), mesh);
    format!(
        r#"<shape type="{plugin}" id="{id}"><string name="filename" value="{file}"/>{placed}{flags}{bsdf}{emitter}</shape>"#
    )
}
