//! Files that are missing, include each other, or are no text; definitions that nothing uses.

use super::{Case, Kind, inside, text};

#[rustfmt::skip]
pub fn cases() -> Vec<Case> {
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
