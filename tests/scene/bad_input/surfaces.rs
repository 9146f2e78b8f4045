//! Materials, textures and lights.

use super::{Case, Kind, inside, mesh, ply};

// One line a case, however long.
#[rustfmt::skip]
// Long: a table.
pub fn cases() -> Vec<Case> {
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
        bsdf("brushed", "roughplastic <float name=\"alpha_u\" value=\"0.1\"/>\n<float name=\"alpha_v\" value=\"0.2\"/>", &["s.xml:4:1", "direction", "\"alpha\""]),
        bsdf("half brushed", "roughconductor <float name=\"alpha_u\" value=\"0.1\"/>", &["s.xml:3:1", "\"alpha_v\" is missing"]),
        bsdf("other half brushed", "roughdielectric <float name=\"alpha_v\" value=\"0.1\"/>", &["s.xml:3:1", "\"alpha_u\" is missing"]),
        bsdf("rough and brushed", "roughconductor <float name=\"alpha_u\" value=\"0.1\"/><float name=\"alpha_v\" value=\"0.1\"/>\n<float name=\"alpha\" value=\"0.1\"/>", &["s.xml:4:1", "\"alpha_u\" and \"alpha_v\""]),
        bsdf("brushed by a texture", "roughconductor <texture type=\"checkerboard\" name=\"alpha_u\"/>", &["s.xml:2:1", "\"alpha_v\" is missing"]),
        bsdf("two opacities", "mask <float name=\"opacity\" value=\"1\"/><bsdf type=\"diffuse\"/>\n<texture type=\"checkerboard\" name=\"opacity\"/>", &["s.xml:4:1", "given twice"]),
        bsdf("opacity above one", "mask <float name=\"opacity\" value=\"2\"/><bsdf type=\"diffuse\"/>", &["s.xml:3:1", "\"opacity\" must be between 0 and 1"]),
        bsdf("mask of nothing", "mask ", &["s.xml:2:1", "one bsdf inside"]),
        bsdf("mask of two", "mask <bsdf type=\"diffuse\"/><bsdf type=\"diffuse\"/>", &["s.xml:2:1", "one bsdf inside"]),
        bsdf("mask inside twosided", "twosided <bsdf type=\"mask\"><bsdf type=\"diffuse\"/></bsdf>", &["s.xml:3:1", "mask", "cannot stand inside a twosided"]),
        bsdf("glass in a blend of two sides", "twosided <bsdf type=\"blendbsdf\"><float name=\"weight\" value=\"0.5\"/><bsdf type=\"diffuse\"/>\n<bsdf type=\"dielectric\"/></bsdf>", &["s.xml:4:1", "cannot stand inside a twosided"]),
        bsdf("blend without a weight", "blendbsdf <bsdf type=\"diffuse\"/><bsdf type=\"diffuse\"/>", &["s.xml:2:1", "needs a \"weight\""]),
        bsdf("blend of one", "blendbsdf <float name=\"weight\" value=\"0.5\"/><bsdf type=\"diffuse\"/>", &["s.xml:2:1", "two bsdfs inside"]),
        bsdf("colours of edges", "diffuse <texture type=\"mesh_attribute\" name=\"reflectance\">\n<string name=\"name\" value=\"edge_color\"/></texture>", &["s.xml:4:1", "\"edge_color\" does not", "face_"]),
        inside("no colours", "<shape type=\"cube\"><bsdf type=\"diffuse\">\n<texture type=\"mesh_attribute\" name=\"reflectance\"><string name=\"name\" value=\"vertex_color\"/></texture></bsdf></shape>", &["s.xml:3:1", "no attributes", "color_0"]),
        bsdf("bumps of nothing", "bumpmap <bsdf type=\"diffuse\"/>", &["s.xml:2:1", "one texture inside"]),
        bsdf("bumps without slopes", "bumpmap <texture type=\"checkerboard\"/><bsdf type=\"diffuse\"/>", &["s.xml:3:1", "bilinear filter"]),
        bsdf("normals of nothing", "normalmap <bsdf type=\"diffuse\"/>", &["s.xml:2:1", "texture named \"normalmap\""]),
        bsdf("normals of no bsdf", "normalmap <rgb name=\"normalmap\" value=\"0.5 0.5 1\"/>", &["s.xml:2:1", "one bsdf inside"]),
        bsdf("normals of a mask", "normalmap <rgb name=\"normalmap\" value=\"0.5 0.5 1\"/>\n<bsdf type=\"mask\"><bsdf type=\"diffuse\"/></bsdf>", &["s.xml:4:1", "cannot stand inside", "put the normalmap inside"]),
        bsdf("normals that look away", "normalmap <rgb name=\"normalmap\" value=\"0.5 0.5 1\"/><bsdf type=\"diffuse\"/>\n<boolean name=\"flip_invalid_normals\" value=\"false\"/>", &["s.xml:4:1", "can only be true"]),
        bsdf("masks without end", &format!("{}{}{}", "mask ", "<bsdf type=\"mask\">".repeat(9), "</bsdf>".repeat(9)), &["s.xml:3:", "more than 8 masks"]),
        bsdf("eta and specular", "principled <float name=\"eta\" value=\"1.5\"/>\n<float name=\"specular\" value=\"0.5\"/>", &["s.xml:4:1", "together with \"eta\""]),
        bsdf("infinite specular", "principled <float name=\"specular\" value=\"12.5\"/>", &["s.xml:3:1", "\"specular\" must be between 0 and 10"]),
        bsdf("texture of eta", "principled <texture type=\"checkerboard\" name=\"eta\"/>", &["s.xml:3:1", "no texture \"eta\""]),
        bsdf("metal above one", "principled <float name=\"metallic\" value=\"1.5\"/>", &["s.xml:3:1", "\"metallic\" must be between 0 and 1"]),
        bsdf("transparent layers inside twosided", "twosided <bsdf type=\"principled\"><float name=\"spec_trans\" value=\"0.5\"/></bsdf>", &["s.xml:3:1", "principled", "cannot stand inside a twosided"]),
        bsdf("pane inside twosided", "twosided <bsdf type=\"thindielectric\"/>", &["s.xml:3:1", "thindielectric", "cannot stand inside"]),
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
