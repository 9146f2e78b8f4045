//! What Mitsuba's other plugins are, and what to do instead.

/// By tag and name. Of each: what it is; what to take in its place.
const OTHERS: &[(&str, &[&str], &str)] = &[
    (
        "shape",
        &["bsplinecurve", "linearcurve"],
        "it is a curve of some width; make it a mesh (ply, obj) or of cylinders",
    ),
    (
        "shape",
        &["sdfgrid"],
        "it is the zero of a distance field; extract its surface to a ply or obj",
    ),
    (
        "shape",
        &["ellipsoids", "ellipsoidsmesh"],
        "it is a cloud of ellipsoids; solid ones can be spheres with a to_world",
    ),
    (
        "shape",
        &["blender", "merge"],
        "it holds other meshes; write these out as ply or obj shapes",
    ),
    (
        "bsdf",
        &["hair"],
        "it scatters light along fibres; the nearest of surfaces are roughconductor and roughplastic",
    ),
    (
        "bsdf",
        &["measured"],
        "it is a measured table; fit a roughconductor or a roughplastic to it",
    ),
    (
        "bsdf",
        &["measured_polarized", "pplastic"],
        "it polarises light, of which nothing is kept here; take roughconductor or roughplastic",
    ),
    (
        "bsdf",
        &["polarizer", "retarder", "circular"],
        "it acts on polarised light, of which nothing is kept here; take it out",
    ),
    (
        "bsdf",
        &[
            "phong",
            "ward",
            "coating",
            "roughcoating",
            "roughdiffuse",
            "difftrans",
            "hk",
            "irawan",
        ],
        "it is of Mitsuba 0.6 and has no successor in Mitsuba 3; take diffuse or roughplastic",
    ),
    (
        "emitter",
        &["sunsky", "timed_sunsky", "sky", "sun"],
        "it computes a sky; render it to a picture for an envmap, and take a directional light for the sun",
    ),
    (
        "emitter",
        &["directionalarea"],
        "it is a surface that shines along its normal only; take a directional or a projector",
    ),
    (
        "emitter",
        &["collimated"],
        "it is a beam of no width; take a spot of a small cutoff_angle",
    ),
    (
        "texture",
        &["volume"],
        "it looks up a volume at the point; bake it into a bitmap over the surface",
    ),
    (
        "sensor",
        &["batch"],
        "it puts several cameras' images side by side; write them as sensors of the scene, which --sensor chooses among",
    ),
    (
        "sensor",
        &["radiancemeter"],
        "it measures along one ray; take a perspective camera of a small fov and one pixel",
    ),
    (
        "sensor",
        &["irradiancemeter"],
        "it measures what falls on a shape; look at the shape, made diffuse and white, from close by",
    ),
    (
        "sensor",
        &["distant"],
        "it sees the scene from infinitely far; take an orthographic camera",
    ),
    (
        "film",
        &["specfilm"],
        "it records a spectrum, and colours here are red, green and blue; take hdrfilm",
    ),
    (
        "rfilter",
        &["mitchell", "catmullrom", "lanczos"],
        "it is negative in places, which gradients of images do not allow for; take gaussian",
    ),
    (
        "integrator",
        &["stokes"],
        "it computes polarisation, of which nothing is kept here; take path",
    ),
    (
        "integrator",
        &["depth"],
        "it shows depths rather than light; take path",
    ),
    (
        "spectrum",
        &[
            "d65",
            "blackbody",
            "uniform",
            "regular",
            "irregular",
            "srgb",
            "rawconstant",
        ],
        "spectra are <spectrum value=\"400:0.1, 700:0.5\"/>, <spectrum filename=\"…\"/> or <rgb>",
    ),
    (
        "sampler",
        &["hammersley", "halton", "sobol"],
        "it is of Mitsuba 0.6; take independent: the image is the same in the mean",
    ),
    (
        "integrator",
        &[
            "bdpt",
            "mlt",
            "pssmlt",
            "erpt",
            "photonmapper",
            "sppm",
            "ppm",
            "irrcache",
            "vpl",
        ],
        "it is of Mitsuba 0.6; take path, which has the same image in the mean",
    ),
];

/// What is said of every plugin of a tag.
const KINDS: &[(&str, &str)] = &[
    (
        "medium",
        "volumes such as fog and smoke are out of scope; take it out, and what holds it is a surface",
    ),
    (
        "phase",
        "it says how a medium scatters, and media are out of scope",
    ),
    (
        "volume",
        "volumes are out of scope; on surfaces, a bitmap may do",
    ),
];

/// What the plugin is and what to do instead, if it is one that Mitsuba knows.
pub(super) fn instead_of(tag: &str, plugin: &str) -> Option<&'static str> {
    let kind = KINDS.iter().find(|k| k.0 == tag).map(|k| k.1);
    let others = || {
        let mut all = OTHERS.iter();
        all.find(|o| o.0 == tag && o.1.contains(&plugin))
            .map(|o| o.2)
    };
    kind.or_else(others)
}
