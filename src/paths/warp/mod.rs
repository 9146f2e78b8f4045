//! The seam between rendering and methods that move samples instead of finding borders.
//!
//! For any velocity field V over directions that is smooth but for the places where the integrand
//! jumps, and that moves there as the jump does,
//!
//!   ∂∫f dω = ∫ (∂f + ∇f·V + f ∇·V) dω.
//!
//! So each sample needs a velocity of its direction and a *score*: what its weight changes by, in
//! parts of itself. Both are linear in the velocities of a few points of surfaces that the sample
//! follows. A point P that x follows turns all directions at x by the smallest rotation that keeps
//! it in view, with the angular velocity Ω = (P − x)×(Ṗ − ẋ)/|P − x|². A rotation has no
//! divergence. With shares s_i(ω) of several points
//!
//!   V = Σ s_i Ω_i×ω,  and  ∇·V = Σ ∇s_i·(Ω_i×ω) = Σ Ω_i·(ω×∇s_i),
//!
//! and a kernel that is drawn from adds to the score in the same way. A [`follow::Follow`] keeps a
//! point, its share, and the vector that Ω is multiplied with in the score: all that the sweeps
//! need, so they serve every such method.

pub mod follow;
pub mod kernel;
pub mod seam;
