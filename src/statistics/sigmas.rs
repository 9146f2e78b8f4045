//! Test statistics of few runs, told as that of a normal distribution which is as rare.

/// Of Student's t with so many degrees of freedom (Wallace 1959, doi:10.1214/aoms/1177706094).
pub fn of_student(t: f64, freedom: f64) -> f64 {
    let size = (freedom * (t * t / freedom).ln_1p()).sqrt();
    (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0) * size.copysign(t)
}

/// What Student's t exceeds as rarely as a normal distribution exceeds `sigmas`: the inverse of
/// [`of_student`].
pub fn student(sigmas: f64, freedom: f64) -> f64 {
    let z = sigmas * (8.0 * freedom + 3.0) / (8.0 * freedom + 1.0);
    (freedom * (z * z / freedom).exp_m1()).sqrt()
}

/// Of a number whose mean is 1 and that is spread as χ²/d, with this standard deviation: d is
/// 2/sd² (Wilson and Hilferty 1931, doi:10.1073/pnas.17.12.684).
pub fn of_chi_squared(value: f64, sd: f64) -> f64 {
    let spread = sd * sd / 9.0;
    (value.max(0.0).cbrt() - (1.0 - spread)) / spread.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use statrs::distribution::{ChiSquared, ContinuousCDF, Normal, StudentsT};

    #[test]
    fn both_are_as_rare_as_the_distributions_say() {
        let normal = Normal::standard();
        for freedom in [7.0, 15.0, 31.0] {
            let student = StudentsT::new(0.0, 1.0, freedom).unwrap();
            for t in [-3.0, 1.0, 2.5, 5.0] {
                let exact = normal.inverse_cdf(student.cdf(t));
                assert!(
                    (of_student(t, freedom) - exact).abs() < 0.05,
                    "{t} {freedom}"
                );
            }
        }
        for freedom in [3.0, 15.0, 63.0] {
            let exact = StudentsT::new(0.0, 1.0, freedom)
                .unwrap()
                .inverse_cdf(0.975);
            let ours = student(1.96, freedom);
            assert!(
                (ours / exact - 1.0).abs() < 0.02,
                "{freedom}: {ours} {exact}"
            );
            assert!((of_student(ours, freedom) - 1.96).abs() < 1e-12);
        }
        for d in [2.0, 10.0, 100.0] {
            let chi = ChiSquared::new(d).unwrap();
            for value in [1.2, 2.0] {
                let exact = -normal.inverse_cdf(chi.sf(value * d));
                let sigmas = of_chi_squared(value, f64::sqrt(2.0 / d));
                assert!(
                    (sigmas - exact).abs() < 0.1,
                    "{value} {d}: {sigmas} {exact}"
                );
            }
        }
    }
}
