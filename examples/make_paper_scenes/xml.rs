//! What all the scene files have in common.

/// A scene but for its frame.
pub struct Scene {
    /// File name without `.xml`.
    pub name: &'static str,
    pub comment: &'static str,
    pub max_depth: u32,
    pub fov: f64,
    pub origin: &'static str,
    pub target: &'static str,
    /// Shapes, materials and lights.
    pub body: String,
}

impl Scene {
    pub fn text(&self, resolution: usize) -> String {
        let Self {
            comment,
            max_depth,
            fov,
            origin,
            target,
            body,
            ..
        } = self;
        let flat = if body.contains("$flat") {
            "\n  <default name=\"flat\" value=\"false\"/>"
        } else {
            ""
        };
        format!(
            r#"<scene version="3.0.0">
  <!-- {comment} -->
  <default name="res" value="{resolution}"/>
  <default name="spp" value="64"/>
  <default name="rfilter" value="gaussian"/>
  <default name="depth" value="{max_depth}"/>{flat}
  <integrator type="path"><integer name="max_depth" value="$depth"/></integrator>
  <sensor type="perspective" id="cam">
    <float name="fov" value="{fov}"/><string name="fov_axis" value="x"/>
    <float name="near_clip" value="0.01"/><float name="far_clip" value="100"/>
    <transform name="to_world"><lookat origin="{origin}" target="{target}" up="0, 0, 1"/></transform>
    <sampler type="independent"><integer name="sample_count" value="$spp"/></sampler>
    <film type="hdrfilm">
      <integer name="width" value="$res"/><integer name="height" value="$res"/>
      <rfilter type="$rfilter"/><boolean name="sample_border" value="true"/>
    </film>
  </sensor>
{body}</scene>
"#
        )
    }
}

/// The star, of radius about 1 before `transform`; `-D flat=true` shades its triangles flat.
pub fn star(transform: &str) -> String {
    ply("obj", "star", "$flat", transform, "0.75, 0.35, 0.12")
}

/// A closed mesh of a diffuse colour.
pub fn ply(id: &str, mesh: &str, flat: &str, transform: &str, colour: &str) -> String {
    format!(
        r#"  <shape type="ply" id="{id}">
    <string name="filename" value="meshes/{mesh}.ply"/><boolean name="face_normals" value="{flat}"/>
    <transform name="to_world">{transform}</transform>
    <bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="{colour}"/></bsdf></bsdf>
  </shape>
"#
    )
}

/// A diffuse grey square of half the side `half`.
pub fn floor(half: f64) -> String {
    format!(
        r#"  <shape type="rectangle" id="floor">
    <transform name="to_world"><scale value="{half}"/></transform>
    <bsdf type="diffuse"><rgb name="reflectance" value="0.65, 0.63, 0.6"/></bsdf>
  </shape>
"#
    )
}

/// A square light that shines down before `transform`.
pub fn lamp(id: &str, transform: &str, radiance: &str) -> String {
    format!(
        r#"  <shape type="rectangle" id="{id}">
    <transform name="to_world"><rotate x="1" angle="180"/>{transform}</transform>
    <emitter type="area"><rgb name="radiance" value="{radiance}"/></emitter>
  </shape>
"#
    )
}

/// The same light from everywhere.
pub fn constant(radiance: &str) -> String {
    format!(
        r#"  <emitter type="constant" id="sky"><rgb name="radiance" value="{radiance}"/></emitter>
"#
    )
}

/// The picture of a sky, its zenith up.
pub fn envmap(file: &str) -> String {
    format!(
        r#"  <emitter type="envmap" id="sky">
    <string name="filename" value="{file}"/>
    <transform name="to_world"><rotate x="1" angle="90"/></transform>
  </emitter>
"#
    )
}
