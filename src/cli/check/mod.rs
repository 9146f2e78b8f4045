//! `warpath check`: forward, backward and finite differences against each other.

mod report;
mod runs;
mod verdict;
mod waves;

use super::arguments::CheckArguments;
use super::exit::Failure;
use super::session::{self, Session};
use crate::jobs::direction;
use crate::scene::Filter;
use crate::statistics::comparison::{Comparison, PICTURE_ROUNDING};
use report::{FOUND, conclude, write_images};
use runs::{Check, MOST_RUNS, SHORTER};
use std::ffi::OsString;
use verdict::{Circumstances, Outcome, SIGNIFICANT, cannot_tell, judge};

/// Runs the three and compares them.
pub fn run(arguments: &CheckArguments, typed: &[OsString]) -> Result<(), Failure> {
    let method = session::method(&arguments.method)?;
    if method.is_reference() {
        return Err(Failure::Usage(format!(
            "--method {} is what the others are checked against",
            method.name()
        )));
    }
    if !method.has_reverse_mode() {
        return Err(Failure::Usage(format!(
            "--method {} takes differences backward, too, which are no transposes of others; \
             compare its forward gradient with that of fd",
            method.name()
        )));
    }
    let session = Session::open("check", &arguments.trace, typed, Some(method), true)?;
    let settings = session.settings.clone();
    let direction = direction::resolve(&session.scene, &arguments.parameters, settings.sensor)?;
    if settings.spp < 2 {
        return Err(Failure::Input(
            "with one sample a pixel there are no standard errors to check against: raise --spp"
                .into(),
        ));
    }
    let mut check = Check::new(session, settings, direction);
    check.session.take_away(FOUND)?;
    check.ask_pilot()?;
    check.announce();
    let first = check.run_tested()?;
    check.tell_time();
    let rounding = check.rounding(&first.image)?;
    let transposition = check.transpose(&first.gradient, rounding / PICTURE_ROUNDING)?;
    let moves = check
        .direction
        .iter()
        .any(|(parameter, _)| parameter.moves_visibility);
    let filter = check.session.scene.sensors[check.settings.sensor]
        .film
        .filter;
    let circumstances = Circumstances {
        ignores_visibility: moves && method.ignores_visibility(),
        box_filter: matches!(filter, Filter::Box { .. }),
        stands: first.statistics.standing > 0,
    };
    let tolerance = arguments.tolerance;
    let name = method.name();
    let judged = |c: &Comparison| judge(name, circumstances, &transposition, c, tolerance);
    let (mut comparison, mut verdict) = loop {
        check.run_all()?;
        let comparison = Comparison::of(&check.tested, &check.reference, rounding);
        let verdict = judged(&comparison);
        let goes_on = arguments.until_sure && verdict.outcome == Outcome::CannotTell;
        let most = if goes_on { usize::MAX } else { MOST_RUNS };
        let is_sharp = comparison.can_tell(tolerance / SIGNIFICANT);
        if is_sharp || !check.plan_more(&comparison, most) {
            break (comparison, verdict);
        }
    };
    let is_doubtful = moves && transposition.agrees;
    if verdict.outcome == Outcome::Disagrees
        && is_doubtful
        && check.takes_shorter_steps(rounding, tolerance)?
    {
        comparison = Comparison::of(&check.tested, &check.reference, SHORTER * rounding);
        verdict = match comparison.reference_is_significant {
            true => judged(&comparison),
            false => cannot_tell(name, &comparison, tolerance),
        };
        verdict.explain(circumstances);
    }
    write_images(&mut check.session, &check.tested, &check.reference)?;
    conclude(
        check.session,
        &verdict,
        &transposition,
        &comparison,
        tolerance,
    )
}
