//! The constants of both methods, with the published ones as defaults.

/// Those of all methods that move samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WarpOptions {
    pub loubet: LoubetOptions,
    pub warped_area: WarpedAreaOptions,
}

/// Loubet et al. (2019), and the program that its authors published (`path-reparam`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoubetOptions {
    /// Rays of a bundle through the film, over a light, and over a lobe or the environment; at
    /// least 2.
    pub film_rays: u32,
    pub light_rays: u32,
    pub lobe_rays: u32,
    /// Standard deviation of the kernel on the film, in pixels: that of a concentration of
    /// 1/(1 − cos 0.4α), with α the angle of a pixel.
    pub film_kernel_px: f64,
    /// Concentration of the kernel around directions of rough lobes.
    pub lobe_kappa: f64,
    /// Lobes with a roughness above this are rough.
    pub least_roughness: f32,
    /// Concentration of the kernel around directions of an environment map.
    pub environment_kappa: f64,
    /// Whether lobes and the environment are convolved at all.
    pub convolution: bool,
    /// Whether two paths share their random numbers, so that the noise of kernels cancels.
    pub pairs: bool,
}

impl Default for LoubetOptions {
    fn default() -> Self {
        Self {
            film_rays: 4,
            light_rays: 4,
            lobe_rays: 4,
            film_kernel_px: 0.283,
            lobe_kappa: 1000.0,
            least_roughness: 0.15,
            environment_kappa: 1e5,
            convolution: true,
            pairs: true,
        }
    }
}

/// Bangaru et al. (2020), with the constants of Falcor's program. Their own has 8 rays, an exponent
/// of 2 and a β of 0.01.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WarpedAreaOptions {
    /// Auxiliary rays of each sample.
    pub rays: u32,
    /// Concentration of auxiliary rays, and of the harmonic weights.
    pub kappa: f64,
    /// The same on the film: a standard deviation in pixels.
    pub film_px: f64,
    /// Exponent of the harmonic weights.
    pub exponent: f64,
    /// β of the test for silhouettes by normals: c²/(β + (1 − β) c²) for a cosine c. 1: c² itself.
    pub beta: f64,
    /// Whether every other ray mirrors the one before it.
    pub antithetic: bool,
    /// Whether the bias of few rays is removed by a random number of them (Russian roulette).
    pub debias: bool,
    /// The chance of another batch of rays then.
    pub debias_chance: f64,
}

impl Default for WarpedAreaOptions {
    fn default() -> Self {
        Self {
            rays: 16,
            kappa: 1e5,
            film_px: 0.2,
            exponent: 3.0,
            beta: 1.0,
            antithetic: true,
            debias: false,
            debias_chance: 0.4,
        }
    }
}
