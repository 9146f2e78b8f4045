//! Broken scenes and meshes: each is refused with the place and a sentence, never with a panic.

use std::path::Path;
use warpath::scene::{SceneError, load};

/// One broken input.
struct Case {
    name: &'static str,
    /// The scene is `s.xml`.
    files: Vec<(&'static str, Vec<u8>)>,
    defines: Vec<(&'static str, &'static str)>,
    kind: Kind,
    /// The message has all of these.
    says: &'static [&'static str],
}

#[derive(Debug, PartialEq)]
enum Kind {
    Scene,
    Mesh,
    Missing,
    Define,
}

fn kind(error: &SceneError) -> Option<Kind> {
    match error {
        SceneError::Scene { .. } => Some(Kind::Scene),
        SceneError::Mesh { .. } => Some(Kind::Mesh),
        SceneError::Missing { .. } => Some(Kind::Missing),
        SceneError::Define { .. } => Some(Kind::Define),
        SceneError::Parameter { .. } | SceneError::Io { .. } => None,
    }
}

/// A scene file with an error.
fn text(name: &'static str, scene: &str, says: &'static [&'static str]) -> Case {
    Case {
        name,
        files: vec![("s.xml", scene.as_bytes().to_vec())],
        defines: Vec::new(),
        kind: Kind::Scene,
        says,
    }
}

const SENSOR: &str = "<sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/></sensor>";

/// `inside` stands on line 2 of an otherwise good scene.
fn inside(name: &'static str, inside: &str, says: &'static [&'static str]) -> Case {
    text(
        name,
        &format!("<scene version=\"3.0.0\">\n{inside}\n{SENSOR}</scene>"),
        says,
    )
}

/// `inside` stands on line 2, in the only sensor.
fn in_sensor(name: &'static str, inside: &str, says: &'static [&'static str]) -> Case {
    let scene = format!(
        "<scene version=\"3.0.0\"><sensor type=\"perspective\">\n{inside}</sensor></scene>"
    );
    text(name, &scene, says)
}

/// A shape that reads the mesh file `file`.
fn mesh(
    name: &'static str,
    file: &'static str,
    bytes: impl Into<Vec<u8>>,
    says: &'static [&'static str],
) -> Case {
    let plugin = if file.ends_with(".ply") { "ply" } else { "obj" };
    let shape =
        format!("<shape type=\"{plugin}\"><string name=\"filename\" value=\"{file}\"/></shape>");
    let mut case = inside(name, &shape, says);
    case.files.push((file, bytes.into()));
    case.kind = Kind::Mesh;
    case
}

fn ply(body: &str) -> String {
    let header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                  element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    format!("{header}{body}")
}

fn binary_ply(vertices: usize, faces: usize, payload: &[u8]) -> Vec<u8> {
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\n\
         property float z\nelement face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    .into_bytes();
    bytes.extend_from_slice(payload);
    bytes
}

/// Three vertices, then one face with these corners.
fn binary_triangle(corners: [i32; 3]) -> Vec<u8> {
    let mut payload = Vec::new();
    for v in [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        payload.extend(v.to_le_bytes());
    }
    payload.push(3);
    for corner in corners {
        payload.extend(corner.to_le_bytes());
    }
    payload
}

#[rustfmt::skip]
fn xml_cases() -> Vec<Case> {
    let deep = format!(
        "<scene version=\"3.0.0\">{}{}</scene>",
        "<bsdf type=\"twosided\">".repeat(5000),
        "</bsdf>".repeat(5000)
    );
    vec![
        text("empty file", "", &["s.xml:1:1", "not well-formed"]),
        text("not XML", "render this please", &["s.xml:1:1", "not well-formed"]),
        text("tag not closed", "<scene version=\"3.0.0\">\n<shape type=\"cube\">\n</scene>", &["s.xml:3:", "not well-formed"]),
        text("an entity bomb", "<!DOCTYPE a [<!ENTITY b \"c\">]>\n<scene version=\"3.0.0\"/>", &["s.xml:1:", "not well-formed"]),
        text("no version", "<scene/>", &["s.xml:1:1", "version=\"3.0.0\""]),
        text("old version", "<scene version=\"0.6.0\"/>", &["s.xml:1:1", "0.6.0"]),
        text("other root", "<shape type=\"cube\" version=\"3.0.0\"/>", &["s.xml:1:1", "<scene>"]),
        text("no sensor", "<scene version=\"3.0.0\"/>", &["s.xml:1:1", "no sensor"]),
        text("nested too deep", &deep, &["s.xml:1:", "nested more than 64 deep"]),
        inside("stray text", "hello", &["s.xml:1:24", "stray text \"hello\""]),
        inside("unknown element", "  <shap type=\"cube\"/>", &["s.xml:2:3", "<shap>", "\"shape\""]),
        inside("unknown attribute", "<shape typ=\"cube\"/>", &["s.xml:2:1", "\"typ\"", "\"type\""]),
        inside("missing attribute", "<shape id=\"a\"/>", &["s.xml:2:1", "lacks the attribute \"type\""]),
        inside("unknown shape", "<shape type=\"spere\"/>", &["s.xml:2:1", "\"spere\"", "\"sphere\""]),
        inside("unknown bsdf", "<shape type=\"cube\"><bsdf type=\"difuse\"/></shape>", &["s.xml:2:20", "\"diffuse\""]),
        inside("volume", "<medium type=\"homogeneous\"/>", &["s.xml:2:1", "homogeneous", "volumes"]),
        inside("volumetric integrator", "<integrator type=\"volpath\"/>", &["s.xml:2:1", "volpath", "\"path\""]),
        inside("volumetric prb", "<integrator type=\"prbvolpath\"/>", &["s.xml:2:1", "prbvolpath"]),
        inside("spectral plugin", "<shape type=\"cube\"><bsdf type=\"diffuse\"><spectrum type=\"blackbody\" name=\"reflectance\"/></bsdf></shape>", &["s.xml:2:41", "blackbody", "spectra"]),
        inside("spectrum by wavelength", "<shape type=\"cube\"><bsdf type=\"diffuse\"><spectrum name=\"reflectance\" value=\"400:0.1, 500:0.2\"/></bsdf></shape>", &["s.xml:2:41", "<spectrum>", "<rgb>"]),
        inside("two integrators", "<integrator type=\"path\"/><integrator type=\"path\"/>", &["s.xml:2:26", "only one integrator"]),
        inside("negative depth", "<integrator type=\"path\">\n<integer name=\"max_depth\" value=\"-2\"/></integrator>", &["s.xml:3:1", "max_depth", "-2"]),
        inside("depth no integer", "<integrator type=\"path\"><integer name=\"max_depth\" value=\"2.5\"/></integrator>", &["s.xml:2:25", "2.5", "not an integer"]),
        inside("depth as string", "<integrator type=\"path\"><string name=\"max_depth\" value=\"2\"/></integrator>", &["s.xml:2:25", "must be a <integer>", "<string>"]),
        inside("zero rr_depth", "<integrator type=\"path\"><integer name=\"rr_depth\" value=\"0\"/></integrator>", &["s.xml:2:25", "rr_depth"]),
        inside("not a boolean", "<integrator type=\"path\"><boolean name=\"hide_emitters\" value=\"yes\"/></integrator>", &["s.xml:2:25", "\"yes\"", "true"]),
        inside("property given twice", "<integrator type=\"path\">\n<integer name=\"max_depth\" value=\"2\"/>\n<integer name=\"max_depth\" value=\"3\"/></integrator>", &["s.xml:4:1", "already", "s.xml:3:1"]),
        inside("element in a property", "<integrator type=\"path\"><integer name=\"max_depth\" value=\"2\"><float name=\"a\" value=\"1\"/></integer></integrator>", &["s.xml:2:61", "<float>"]),
        inside("film in the scene", "<film type=\"hdrfilm\"/>", &["s.xml:2:1", "hdrfilm", "cannot stand inside"]),
        inside("duplicate id", "<shape type=\"cube\" id=\"a\"/>\n<shape type=\"cube\" id=\"a\"/>", &["s.xml:3:1", "duplicate id \"a\"", "s.xml:2:1"]),
        inside("missing id", "<bsdf type=\"diffuse\" id=\"grey\"/><shape type=\"cube\">\n <ref id=\"gray\"/></shape>", &["s.xml:3:2", "\"gray\"", "\"grey\""]),
        inside("bsdf in itself", "<bsdf type=\"twosided\" id=\"a\">\n<ref id=\"a\"/></bsdf>", &["s.xml:3:1", "contain itself"]),
        inside("bsdfs in each other", "<bsdf type=\"twosided\" id=\"a\"><ref id=\"b\"/></bsdf>\n<bsdf type=\"twosided\" id=\"b\"><ref id=\"a\"/></bsdf>", &["s.xml:3:30", "contain itself"]),
        inside("empty twosided", "<bsdf type=\"twosided\" id=\"a\"/>", &["s.xml:2:1", "needs a bsdf"]),
        inside("two bsdfs", "<shape type=\"cube\"><bsdf type=\"diffuse\"/><bsdf type=\"diffuse\"/></shape>", &["s.xml:2:42", "only one bsdf"]),
        inside("emission above one", "<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"0.5 1.5 0.5\"/></bsdf>", &["s.xml:2:22", "between 0 and 1"]),
        inside("two colour values", "<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"0.5 0.5\"/></bsdf>", &["s.xml:2:22", "one or three"]),
        inside("bad hex", "<bsdf type=\"diffuse\"><srgb name=\"reflectance\" value=\"#12345g\"/></bsdf>", &["s.xml:2:22", "#rrggbb"]),
        inside("negative radiance", "<emitter type=\"constant\"><rgb name=\"radiance\" value=\"-1\"/></emitter>", &["s.xml:2:26", "at least 0"]),
        inside("two environments", "<emitter type=\"constant\"/>\n<emitter type=\"constant\"/>", &["s.xml:3:1", "only one environment"]),
        inside("area emitter in the scene", "<emitter type=\"area\"/>", &["s.xml:2:1", "inside the shape"]),
        inside("one light for two shapes", "<shape type=\"cube\"><emitter type=\"area\" id=\"l\"/></shape>\n<shape type=\"cube\"><ref id=\"l\"/></shape>", &["s.xml:3:20", "one shape only"]),
        inside("number too large", "<shape type=\"sphere\"><float name=\"radius\" value=\"1e39\"/></shape>", &["s.xml:2:22", "1e39"]),
        inside("not a number", "<shape type=\"sphere\"><float name=\"radius\" value=\"big\"/></shape>", &["s.xml:2:22", "\"big\" is not a number"]),
        inside("NaN", "<shape type=\"sphere\"><float name=\"radius\" value=\"nan\"/></shape>", &["s.xml:2:22", "finite"]),
        inside("negative radius", "<shape type=\"sphere\"><float name=\"radius\" value=\"-1\"/></shape>", &["s.xml:2:22", "greater than zero"]),
        inside("point without coordinates", "<shape type=\"sphere\"><point name=\"center\" value=\"1 2\"/></shape>", &["s.xml:2:22", "one or three"]),
        inside("unknown operation", "<shape type=\"cube\"><transform name=\"to_world\">\n<rotat x=\"1\" angle=\"3\"/></transform></shape>", &["s.xml:3:1", "\"rotate\""]),
        inside("zero axis", "<shape type=\"cube\"><transform name=\"to_world\">\n<rotate angle=\"3\"/></transform></shape>", &["s.xml:3:1", "axis is zero"]),
        inside("wrong matrix", "<shape type=\"cube\"><transform name=\"to_world\">\n<matrix value=\"1 2 3\"/></transform></shape>", &["s.xml:3:1", "9 or 16"]),
        inside("projective matrix", "<shape type=\"cube\"><transform name=\"to_world\">\n<matrix value=\"1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1\"/></transform></shape>", &["s.xml:3:1", "last row"]),
        inside("flat transform", "<shape type=\"cube\"><transform name=\"to_world\"><scale z=\"0\"/></transform></shape>", &["s.xml:2:20", "flattens"]),
        inside("looking nowhere", "<shape type=\"cube\"><transform name=\"to_world\">\n<lookat origin=\"1 1 1\" target=\"1 1 1\" up=\"0 0 1\"/></transform></shape>", &["s.xml:3:1", "same point"]),
        inside("transform outside", "<translate x=\"1\"/>", &["s.xml:2:1", "inside <transform>"]),
        inside("undefined parameter", "<default name=\"spp\" value=\"1\"/><shape type=\"$sp\"/>", &["s.xml:2:32", "$sp;", "$spp"]),
        inside("no filename", "<shape type=\"ply\"/>", &["s.xml:2:1", "filename"]),
        inside("no such mesh", "<shape type=\"ply\"><string name=\"filename\" value=\"nope.ply\"/></shape>", &["s.xml:2:19", "nope.ply"]),
        inside("mesh is a folder", "<shape type=\"ply\"><string name=\"filename\" value=\".\"/></shape>", &["s.xml:2:19", "not a regular file"]),
        inside("no such include", "<include filename=\"nope.xml\"/>", &["s.xml:2:1", "nope.xml"]),
        inside("include of itself", "<include filename=\"s.xml\"/>", &["s.xml:2:1", "includes itself"]),
    ]
}

#[rustfmt::skip]
fn surface_cases() -> Vec<Case> {
    let bsdf = |name, inside: &str, says| {
        let plugin = inside.split_once(' ').map_or((inside, ""), |p| p);
        self::inside(name, &format!("<bsdf type=\"{}\">\n{}</bsdf>", plugin.0, plugin.1), says)
    };
    let emitter = |name, plugin: &str, inside: &str, says| {
        self::inside(name, &format!("<emitter type=\"{plugin}\">\n{inside}</emitter>"), says)
    };
    let board = "<texture type=\"checkerboard\" name=\"reflectance\">";
    vec![
        bsdf("unknown metal", "conductor <string name=\"material\" value=\"au\"/>", &["s.xml:3:1", "\"au\"", "\"Au\""]),
        bsdf("metal and eta", "conductor <string name=\"material\" value=\"Au\"/><rgb name=\"eta\" value=\"1\"/>", &["s.xml:3:", "\"eta\" cannot be given together"]),
        bsdf("metal and k", "roughconductor <string name=\"material\" value=\"Au\"/><rgb name=\"k\" value=\"1\"/>", &["s.xml:3:", "\"k\" cannot be given together"]),
        bsdf("metal and a texture of k", "conductor <string name=\"material\" value=\"Au\"/><texture type=\"checkerboard\" name=\"k\"/>", &["s.xml:3:", "\"k\" cannot be given together"]),
        bsdf("negative k", "conductor <rgb name=\"k\" value=\"1 -1 1\"/>", &["s.xml:3:1", "\"k\" must be between 0 and 1000000"]),
        bsdf("mirror above one", "conductor <rgb name=\"specular_reflectance\" value=\"2\"/>", &["s.xml:3:1", "between 0 and 1", "not 2"]),
        bsdf("unknown distribution", "roughconductor <string name=\"distribution\" value=\"gxx\"/>", &["s.xml:3:1", "\"ggx\"", "beckmann"]),
        bsdf("negative roughness", "roughconductor <float name=\"alpha\" value=\"-0.1\"/>", &["s.xml:3:1", "\"alpha\" must be between 0 and 1", "-0.1"]),
        bsdf("roughness above one", "roughdielectric <float name=\"alpha\" value=\"1.5\"/>", &["s.xml:3:1", "\"alpha\"", "1.5"]),
        bsdf("roughness in colour", "roughplastic <rgb name=\"alpha\" value=\"0.1 0.2 0.3\"/>", &["s.xml:3:1", "must be a <float>", "<rgb>"]),
        bsdf("brushed", "roughconductor <float name=\"alpha_u\" value=\"0.1\"/>\n<float name=\"alpha_v\" value=\"0.2\"/>", &["s.xml:4:1", "direction", "\"alpha\""]),
        bsdf("half brushed", "roughconductor <float name=\"alpha_u\" value=\"0.1\"/>", &["s.xml:3:1", "\"alpha_v\" is missing"]),
        bsdf("other half brushed", "roughdielectric <float name=\"alpha_v\" value=\"0.1\"/>", &["s.xml:3:1", "\"alpha_u\" is missing"]),
        bsdf("rough and brushed", "roughconductor <float name=\"alpha_u\" value=\"0.1\"/><float name=\"alpha_v\" value=\"0.1\"/>\n<float name=\"alpha\" value=\"0.1\"/>", &["s.xml:4:1", "\"alpha_u\" and \"alpha_v\""]),
        bsdf("brushed by a texture", "roughconductor <texture type=\"checkerboard\" name=\"alpha_u\"/>", &["s.xml:3:1", "no texture \"alpha_u\"", "\"alpha\""]),
        bsdf("texture of roughplastic", "roughplastic <texture type=\"checkerboard\" name=\"alpha\"/>", &["s.xml:3:1", "a number, not a texture"]),
        bsdf("unknown glass", "dielectric <string name=\"int_ior\" value=\"diamand\"/>", &["s.xml:3:1", "\"diamand\"", "\"diamond\""]),
        bsdf("number as name", "dielectric <string name=\"ext_ior\" value=\"1.5\"/>", &["s.xml:3:1", "\"1.5\"", "<float name=\"ext_ior\""]),
        bsdf("index of zero", "plastic <float name=\"int_ior\" value=\"0\"/>", &["s.xml:3:1", "greater than zero"]),
        bsdf("index of thousands", "dielectric <float name=\"int_ior\" value=\"5000\"/>", &["s.xml:3:1", "between 0.01 and 100"]),
        bsdf("rough nothing", "roughdielectric <float name=\"int_ior\" value=\"1.5\"/><float name=\"ext_ior\" value=\"1.5\"/>", &["s.xml:3:1", "differs"]),
        bsdf("nonlinear is no number", "plastic <float name=\"nonlinear\" value=\"1\"/>", &["s.xml:3:1", "must be a <boolean>"]),
        bsdf("glass inside twosided", "twosided <bsdf type=\"dielectric\"/>", &["s.xml:3:1", "dielectric", "cannot stand inside a twosided"]),
        bsdf("rough glass inside twosided", "twosided <bsdf type=\"roughdielectric\"/>", &["s.xml:3:1", "roughdielectric"]),
        bsdf("nothing inside twosided", "twosided <bsdf type=\"null\"/>", &["s.xml:3:1", "null", "lets light through"]),
        bsdf("two sides", "twosided <bsdf type=\"diffuse\"/>\n<bsdf type=\"plastic\"/>", &["s.xml:4:1", "one bsdf"]),
        bsdf("bsdf inside a conductor", "conductor <bsdf type=\"diffuse\"/>", &["s.xml:3:1", "cannot stand inside"]),
        bsdf("texture inside null", "null <texture type=\"checkerboard\" name=\"reflectance\"/>", &["s.xml:3:1", "takes no texture"]),
        bsdf("texture for nothing", "diffuse <texture type=\"checkerboard\"/>", &["s.xml:3:1", "name=\"reflectance\""]),
        bsdf("texture in a slot that is not there", "diffuse <texture type=\"checkerboard\" name=\"reflectanc\"/>", &["s.xml:3:1", "\"reflectanc\"", "\"reflectance\""]),
        bsdf("colour and texture", &format!("diffuse <rgb name=\"reflectance\" value=\"1\"/>\n{board}</texture>"), &["s.xml:4:1", "given twice"]),
        bsdf("two textures", &format!("diffuse {board}</texture>\n{board}</texture>"), &["s.xml:4:1", "given twice"]),
        bsdf("unknown texture", "diffuse <texture type=\"chekerboard\" name=\"reflectance\"/>", &["s.xml:3:1", "\"checkerboard\""]),
        bsdf("checkerboard of emission", &format!("diffuse {board}<rgb name=\"color1\" value=\"3\"/></texture>"), &["s.xml:3:1", "between 0 and 1", "3"]),
        bsdf("texture in a checkerboard", &format!("diffuse {board}\n<texture type=\"checkerboard\" name=\"color0\"/></texture>"), &["s.xml:4:1", "constant"]),
        bsdf("to_uv out of the plane", &format!("diffuse {board}\n<transform name=\"to_uv\"><rotate x=\"1\" angle=\"30\"/></transform></texture>"), &["s.xml:4:1", "plane of u and v"]),
        bsdf("flat to_uv", &format!("diffuse {board}\n<transform name=\"to_uv\"><scale x=\"0\"/></transform></texture>"), &["s.xml:4:1", "flattens"]),
        bsdf("bitmap without a file", "diffuse <texture type=\"bitmap\" name=\"reflectance\"/>", &["s.xml:3:1", "no \"filename\""]),
        bsdf("bitmap of no file", "diffuse <texture type=\"bitmap\" name=\"reflectance\">\n<string name=\"filename\" value=\"nope.png\"/></texture>", &["s.xml:4:1", "nope.png"]),
        bsdf("unknown wrap mode", "diffuse <texture type=\"bitmap\" name=\"reflectance\">\n<string name=\"wrap_mode\" value=\"repat\"/></texture>", &["s.xml:4:1", "\"repeat\""]),
        bsdf("unknown filter", "diffuse <texture type=\"bitmap\" name=\"reflectance\">\n<string name=\"filter_type\" value=\"cubic\"/></texture>", &["s.xml:4:1", "bilinear, nearest"]),
        inside("colour and number", "<texture type=\"checkerboard\" id=\"t\"/><bsdf type=\"diffuse\"><ref id=\"t\" name=\"reflectance\"/></bsdf>\n<bsdf type=\"roughconductor\"><ref id=\"t\" name=\"alpha\"/></bsdf>", &["s.xml:3:29", "both as a colour and as a number"]),
        inside("shared with emission", "<texture type=\"checkerboard\" id=\"t\"><float name=\"color0\" value=\"5\"/></texture><shape type=\"cube\"><emitter type=\"area\"><ref id=\"t\" name=\"radiance\"/></emitter></shape>\n<bsdf type=\"diffuse\"><ref id=\"t\" name=\"reflectance\"/></bsdf>", &["s.xml:3:22", "between 0 and 1", "5"]),
        inside("texture on a shape", "<shape type=\"cube\">\n<texture type=\"checkerboard\"/></shape>", &["s.xml:3:1", "cannot stand inside"]),
        inside("wrong texture in the scene", "<texture type=\"checkerboard\" id=\"t\">\n<rgb name=\"color0\" value=\"-1\"/></texture>", &["s.xml:2:1", "at least 0"]),
        inside("light with a transform", "<shape type=\"cube\"><emitter type=\"area\">\n<transform name=\"to_world\"/></emitter></shape>", &["s.xml:3:1", "goes with its shape"]),
        emitter("environment without a file", "envmap", "", &["s.xml:2:1", "no \"filename\""]),
        emitter("scaled environment", "envmap", "<transform name=\"to_world\"><scale value=\"2\"/></transform>", &["s.xml:3:1", "environment's to_world", "scale"]),
        emitter("dark environment", "envmap", "<float name=\"scale\" value=\"-1\"/>", &["s.xml:3:1", "must not be negative"]),
        emitter("point in two places", "point", "<point name=\"position\" value=\"0\"/>\n<transform name=\"to_world\"/>", &["s.xml:4:1", "together with \"position\""]),
        emitter("negative point", "point", "<rgb name=\"intensity\" value=\"1 -2 1\"/>", &["s.xml:3:1", "at least 0"]),
        emitter("textured point", "point", "<texture type=\"checkerboard\" name=\"intensity\"/>", &["s.xml:3:1", "cannot stand inside"]),
        emitter("no direction", "directional", "<vector name=\"direction\" value=\"0\"/>", &["s.xml:3:1", "no length"]),
        emitter("two directions", "directional", "<vector name=\"direction\" x=\"1\"/>\n<transform name=\"to_world\"/>", &["s.xml:4:1", "together with \"direction\""]),
        emitter("textured sky", "constant", "<texture type=\"checkerboard\" name=\"radiance\"/>", &["s.xml:3:1", "cannot stand inside"]),
        picture("no picture", "diffuse", "reflectance", b"hello".to_vec(), &["s.xml:3:1", "m.pfm"]),
        picture("truncated picture", "diffuse", "reflectance", floats(2, 2, 0.5)[..40].to_vec(), &["s.xml:3:1", "m.pfm"]),
        picture("picture of infinity", "diffuse", "reflectance", floats(2, 2, f32::INFINITY), &["s.xml:3:1", "m.pfm", "not finite"]),
        picture("picture of emission", "diffuse", "reflectance", floats(2, 2, 1.5), &["s.xml:2:22", "between 0 and 1", "column 0, row 0", "1.5"]),
        picture("picture of negative roughness", "roughconductor", "alpha", floats(2, 2, -1.0), &["s.xml:2:29", "column 0, row 0", "-1"]),
        sky("small sky", floats(2, 2, 1.0), &["s.xml:3:1", "2 columns and 3 rows"]),
        sky("negative sky", floats(4, 4, -1.0), &["s.xml:3:1", "at least 0"]),
        textured("no coordinates in a ply", "m.ply", ply("0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), Kind::Scene, &["s.xml:3:1", "no texture coordinates"]),
        textured("no coordinates in an obj", "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", Kind::Scene, &["s.xml:3:1", "no texture coordinates"]),
        textured("some coordinates in an obj", "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\nf 1/1 2 3/1\n", Kind::Mesh, &["m.obj:6", "no texture coordinates"]),
        textured("coordinate out of range", "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/2 3/1\n", Kind::Mesh, &["m.obj:5", "texture coordinate index 2"]),
        textured("half a coordinate", "m.obj", "vt 0.5\n", Kind::Mesh, &["m.obj:1", "two numbers"]),
        textured("infinite coordinate", "m.ply", ply("0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").replace("property float z\n", "property float z\nproperty float s\nproperty float t\n").replace("1 0 0\n", "1 0 0 inf 0\n").replace("\n0 0 0\n", "\n0 0 0 0 0\n").replace("\n0 1 0\n", "\n0 1 0 0 0\n"), Kind::Mesh, &["m.ply", "vertex 1", "not finite"]),
    ]
}

/// A rectangle whose `slot` reads the picture `m.pfm` on line 3.
fn picture(
    name: &'static str,
    plugin: &str,
    slot: &str,
    bytes: Vec<u8>,
    says: &'static [&'static str],
) -> Case {
    let bsdf = format!(
        "<bsdf type=\"{plugin}\"><texture type=\"bitmap\" name=\"{slot}\">\n\
         <string name=\"filename\" value=\"m.pfm\"/></texture></bsdf>"
    );
    let mut case = inside(name, &bsdf, says);
    case.files.push(("m.pfm", bytes));
    case
}

/// An environment map `m.pfm`, named on line 3.
fn sky(name: &'static str, bytes: Vec<u8>, says: &'static [&'static str]) -> Case {
    let emitter =
        "<emitter type=\"envmap\">\n<string name=\"filename\" value=\"m.pfm\"/></emitter>";
    let mut case = inside(name, emitter, says);
    case.files.push(("m.pfm", bytes));
    case
}

/// A picture of one colour.
fn floats(width: usize, height: usize, value: f32) -> Vec<u8> {
    let header = format!("PF\n{width} {height}\n-1.0\n").into_bytes();
    [header, value.to_le_bytes().repeat(3 * width * height)].concat()
}

/// A shape with a texture that reads the mesh file `file` on line 3.
fn textured(
    name: &'static str,
    file: &'static str,
    bytes: impl Into<Vec<u8>>,
    kind: Kind,
    says: &'static [&'static str],
) -> Case {
    let mut case = mesh(name, file, bytes, says);
    let plugin = &file[2..];
    let shape = format!(
        "<shape type=\"{plugin}\">\n<string name=\"filename\" value=\"{file}\"/><bsdf type=\"diffuse\">\
         <texture type=\"checkerboard\" name=\"reflectance\"/></bsdf></shape>"
    );
    case.files[0] = inside(name, &shape, says).files.remove(0);
    case.kind = kind;
    case
}

#[rustfmt::skip]
fn sensor_cases() -> Vec<Case> {
    let fov = "<float name=\"fov\" value=\"40\"/>";
    vec![
        in_sensor("no fov", "", &["s.xml:1:24", "\"fov\""]),
        in_sensor("focal length", "<string name=\"focal_length\" value=\"50mm\"/>", &["s.xml:2:1", "not supported yet"]),
        in_sensor("fov of 180", "<float name=\"fov\" value=\"180\"/>", &["s.xml:2:1", "between 0 and 180"]),
        in_sensor("fov axis", &format!("{fov}\n<string name=\"fov_axis\" value=\"diag\"/>"), &["s.xml:3:1", "\"diagonal\""]),
        in_sensor("scaled camera", &format!("{fov}\n<transform name=\"to_world\"><scale value=\"2\"/></transform>"), &["s.xml:3:1", "scale"]),
        in_sensor("clip planes", &format!("{fov}\n<float name=\"near_clip\" value=\"10\"/><float name=\"far_clip\" value=\"1\"/>" ), &["s.xml:3:1", "near_clip"]),
        in_sensor("near clip of zero", &format!("{fov}\n<float name=\"near_clip\" value=\"0\"/>"), &["s.xml:3:1", "greater than zero"]),
        in_sensor("two films", &format!("{fov}<film type=\"hdrfilm\"/>\n<film type=\"hdrfilm\"/>"), &["s.xml:3:1", "only one film"]),
        in_sensor("width of zero", &format!("{fov}\n<film type=\"hdrfilm\"><integer name=\"width\" value=\"0\"/></film>"), &["s.xml:3:22", "width"]),
        in_sensor("huge width", &format!("{fov}\n<film type=\"hdrfilm\"><integer name=\"width\" value=\"4000000000\"/></film>" ), &["s.xml:3:22", "65536"]),
        in_sensor("crop outside", &format!("{fov}\n<film type=\"hdrfilm\"><integer name=\"crop_offset_x\" value=\"700\"/><integer name=\"crop_width\" value=\"100\"/></film>" ), &["s.xml:3:22", "does not fit", "768"]),
        in_sensor("pixel format", &format!("{fov}\n<film type=\"hdrfilm\"><string name=\"pixel_format\" value=\"rgbb\"/></film>" ), &["s.xml:3:22", "rgbb"]),
        in_sensor("unknown filter", &format!("{fov}<film type=\"hdrfilm\">\n<rfilter type=\"lanczos\"/></film>"), &["s.xml:3:1", "lanczos"]),
        in_sensor("filter of zero width", &format!("{fov}<film type=\"hdrfilm\"><rfilter type=\"gaussian\">\n<float name=\"stddev\" value=\"0\"/></rfilter></film>" ), &["s.xml:3:1", "stddev"]),
        in_sensor("no samples", &format!("{fov}<sampler type=\"independent\">\n<integer name=\"sample_count\" value=\"0\"/></sampler>" ), &["s.xml:3:1", "sample_count"]),
    ]
}

#[rustfmt::skip]
fn file_cases() -> Vec<Case> {
    let mut include = inside(
        "error in an include",
        "<include filename=\"sub/part.xml\"/>",
        &["part.xml:2:4", "\"cube\""],
    );
    include.files.push((
        "sub/part.xml",
        b"<scene version=\"3.0.0\">\n   <shape type=\"cub\"/></scene>".to_vec(),
    ));
    let mut ring = inside(
        "includes in a ring",
        "<include filename=\"a.xml\"/>",
        &["a.xml:1:24", "s.xml includes itself"],
    );
    ring.files.push((
        "a.xml",
        b"<scene version=\"3.0.0\"><include filename=\"s.xml\"/></scene>".to_vec(),
    ));
    let mut twice = inside(
        "same file included twice",
        "<include filename=\"a.xml\"/><include filename=\"a.xml\"/>",
        &["a.xml:1:24", "duplicate id"],
    );
    twice.files.push((
        "a.xml",
        b"<scene version=\"3.0.0\"><shape type=\"cube\" id=\"x\"/></scene>".to_vec(),
    ));
    let mut latin = text("not UTF-8", "", &["s.xml:2:9", "UTF-8"]);
    latin.files[0].1 = b"<scene version=\"3.0.0\">\n<!-- caf\xe9 --></scene>".to_vec();
    let mut unused = inside(
        "unused -D",
        "<default name=\"spp\" value=\"4\"/><integrator type=\"path\"><integer name=\"rr_depth\" value=\"$spp\"/></integrator>",
        &["-D ssp", "\"spp\""],
    );
    unused.defines.push(("ssp", "8"));
    unused.kind = Kind::Define;
    let mut idle = inside(
        "-D of an idle default",
        "<default name=\"spp\" value=\"4\"/>",
        &["-D spp", "uses it nowhere"],
    );
    idle.defines.push(("spp", "8"));
    idle.kind = Kind::Define;
    let mut missing = text("no scene", "", &["s.xml", "no such file"]);
    missing.files.clear();
    missing.kind = Kind::Missing;
    vec![include, ring, twice, latin, unused, idle, missing]
}

#[rustfmt::skip]
fn mesh_cases() -> Vec<Case> {
    let good = "0 0 0\n1 0 0\n0 1 0\n";
    vec![
        mesh("empty ply", "m.ply", "", &["m.ply", "s.xml:2:1"]),
        mesh("not a ply", "m.ply", "hello\n", &["m.ply:1", "PLY header"]),
        mesh("header line", "m.ply", "ply\nformat ascii 1.0\nelemnt vertex 3\nend_header\n", &["m.ply:3"]),
        mesh("header without end", "m.ply", "ply\nformat ascii 1.0\nelement vertex 3\n", &["m.ply", "end_header"]),
        mesh("no faces declared", "m.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n", &["m.ply", "\"face\""]),
        mesh("no z", "m.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n0 0\n", &["m.ply", "\"z\""]),
        mesh("no corners", "m.ply", "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nelement face 0\nproperty int material\nend_header\n", &["m.ply", "vertex_indices"]),
        mesh("same property twice", "m.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n", &["m.ply", "same name"]),
        mesh("element without properties", "m.ply", "ply\nformat binary_little_endian 1.0\nelement nothing 18446744073709551615\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n", &["m.ply", "\"nothing\""]),
        mesh("faces of zero", "m.ply", binary_ply(0, 0, &[]), &["m.ply", "no faces"]),
        mesh("billions claimed", "m.ply", binary_ply(4_000_000_000, 4_000_000_000, &[0; 100]), &["m.ply", "truncated", "100 bytes"]),
        mesh("truncated binary", "m.ply", binary_ply(3, 1, &binary_triangle([0, 1, 2])[..45]), &["m.ply", "face 0", "truncated"]),
        mesh("more than declared", "m.ply", binary_ply(3, 1, &[binary_triangle([0, 1, 2]), vec![0; 4]].concat()), &["m.ply", "4 bytes follow"]),
        mesh("index out of range", "m.ply", binary_ply(3, 1, &binary_triangle([0, 1, 3])), &["m.ply", "face 0", "index 3", "3 vertices"]),
        mesh("negative index", "m.ply", binary_ply(3, 1, &binary_triangle([0, 1, -1])), &["m.ply", "face 0", "-1"]),
        mesh("truncated ascii", "m.ply", ply("0 0 0\n1 0 0\n"), &["m.ply", "truncated"]),
        mesh("a word in ascii", "m.ply", ply("0 0 0\n1 zero 0\n0 1 0\n3 0 1 2\n"), &["m.ply:11", "\"zero\"", "vertex 1"]),
        mesh("NaN vertex", "m.ply", ply("0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n"), &["m.ply", "vertex 1", "not finite"]),
        mesh("ascii index", "m.ply", ply(&format!("{good}3 0 1 9\n")), &["m.ply", "face 0", "index 9"]),
        mesh("ascii negative index", "m.ply", ply(&format!("{good}3 0 1 -2\n")), &["m.ply:13", "\"-2\""]),
        mesh("two corners", "m.ply", ply(&format!("{good}2 0 1\n")), &["m.ply", "face 0", "3 corners"]),
        mesh("ascii rest", "m.ply", ply(&format!("{good}3 0 1 2\n3 0 1 2\n")), &["m.ply:14", "more after"]),
        mesh("no area at all", "m.ply", ply("0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n"), &["m.ply", "none of the mesh's 1 faces"]),
        mesh("empty obj", "m.obj", "", &["m.obj", "no faces"]),
        mesh("obj vertex", "m.obj", "v 0 0\n", &["m.obj:1", "three numbers"]),
        mesh("obj word", "m.obj", "# made by hand\nv 0 0 zero\n", &["m.obj:2", "\"zero\""]),
        mesh("obj infinity", "m.obj", "v 0 0 1e999\n", &["m.obj:1", "not finite"]),
        mesh("obj index", "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", &["m.obj:4", "index 4"]),
        mesh("obj index zero", "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", &["m.obj:4", "index 0"]),
        mesh("obj negative index", "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -4\n", &["m.obj:4", "index -4"]),
        mesh("obj normal index", "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1//1 2//1 3//1\n", &["m.obj:4", "normal index 1"]),
        mesh("obj line", "m.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n", &["m.obj:3", "3 corners"]),
        mesh("obj corner", "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1/1/1 2 3\n", &["m.obj:4", "three indices"]),
    ]
}

fn run(case: &Case, folder: &Path) -> Result<(), String> {
    for (name, bytes) in &case.files {
        let path = folder.join(name);
        std::fs::create_dir_all(path.parent().unwrap_or(folder)).map_err(|e| e.to_string())?;
        std::fs::write(path, bytes).map_err(|e| e.to_string())?;
    }
    let defines: Vec<(String, String)> = case
        .defines
        .iter()
        .map(|(n, v)| (n.to_string(), v.to_string()))
        .collect();
    let Err(error) = load(folder.join("s.xml"), &defines) else {
        return Err("it loaded".to_string());
    };
    let message = error.to_string();
    if kind(&error).as_ref() != Some(&case.kind) {
        return Err(format!("{error:?} is no {:?} error", case.kind));
    }
    if message.lines().count() > 2 || message.len() > 500 {
        return Err(format!("too long: {message}"));
    }
    match case.says.iter().find(|part| !message.contains(**part)) {
        Some(part) => Err(format!("\"{part}\" is not in: {message}")),
        None => Ok(()),
    }
}

#[test]
fn broken_scenes_and_meshes_are_refused_with_their_place() {
    let cases: Vec<Case> = [
        xml_cases(),
        surface_cases(),
        sensor_cases(),
        file_cases(),
        mesh_cases(),
    ]
    .into_iter()
    .flatten()
    .collect();
    assert!(cases.len() >= 150);
    let mut failures = Vec::new();
    for case in &cases {
        let folder = tempfile::tempdir().unwrap();
        if let Err(what) = run(case, folder.path()) {
            failures.push(format!("{}: {what}", case.name));
        }
    }
    assert!(
        failures.is_empty(),
        "{} of {} cases:\n{}",
        failures.len(),
        cases.len(),
        failures.join("\n")
    );
}
