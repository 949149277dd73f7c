//! Song 2014: the ring of corridors.

use fieldwalk::geometry::Point2;
use fieldwalk::system::Recipe;
use fieldwalk_sim::scenario::{Scenario, Walk};
use fieldwalk_sim::walker::WalkerProfile;

use crate::evaluation::Start;
use crate::plot::cdf;
use crate::reproduce::estimate::mean_of;
use crate::reproduce::surveyed::Surveyed;
use crate::reproduce::{Estimate, Experiment, Finding, Findings, Picture, Run};

/// What is measured for this paper.
pub const EXPERIMENTS: &[Experiment] = &[Experiment {
    name: "fourteen places of the ring",
    claims: &["song-nn", "song-pf", "song-modified", "song-order"],
    is_timed: false,
    run,
}];

const N_SEEDS: u64 = 60;
/// Places, a metre apart, in the middle of the lower long corridor.
///
/// # Source
/// Song 2014, §4: fourteen places; where on the ring is ours.
const N_PLACES: usize = 14;
const FIRST_PLACE: Point2 = Point2::new(26.0, 0.9);
/// The start is known to within a range of five metres: the circle round this square.
///
/// # Source
/// Song 2014, §4: "the range of initial location was limited to 5m". Read as what is across, not as a radius: the largest
/// errors of all three methods are 2.86 and 2.90 m, which places guessed up to five metres to either side would exceed.
const START: Start = Start::Known { radius_m: 1.77 };
/// One phone surveys and tests, as in the paper, and one person carries it: whoever is taller holds it where the field is
/// another.
const PHONE: u64 = 1;
/// A fix is asked of who stands after so many seconds.
const STOOD_S: i64 = 2;

/// A method, the steps that it is given, and its claim.
const METHODS: [(&str, f64, &str); 3] =
    [("nearest", 0.0, "song-nn"), ("particle-100", 15.0, "song-pf"), ("candidates", 10.0, "song-modified")];

/// Errors of each method at each place, in metres.
fn errors_m(seed: u64) -> [Vec<f64>; 3] {
    let Some(ring) = Scenario::named("ring", seed) else { return Default::default() };
    let ring = Surveyed::of(ring, |walk| Walk { device: PHONE, ..walk });
    METHODS.map(|(name, n_steps, _)| {
        let Some(recipe) = Recipe::named(name) else { return Vec::new() };
        let error_m = |k: usize| {
            let place = FIRST_PLACE + Point2::new(k as f64, 0.0);
            let one = seed * N_PLACES as u64 + k as u64;
            let walker = WalkerProfile::default();
            let before_m = n_steps * walker.step_length_m(walker.speed_m_s);
            // Who stands goes on from there, after the fix.
            let path = if n_steps > 0.0 {
                vec![place - Point2::new(before_m, 0.0), place]
            } else {
                vec![place, place + Point2::new(2.0, 0.0)]
            };
            let walk = Walk { walker, device: PHONE, ..Walk::along(name, path, one) };
            let mut walked = ring.walked(&walk, STOOD_S)?;
            // The one fix that counts: at the end of the walk, or while standing.
            let n = walked.truth.len();
            walked.truth.rotate_left(if n_steps > 0.0 { n.saturating_sub(1) } else { 0 });
            walked.truth.truncate(1);
            ring.errors_m(&recipe, START, one, &walked).first().copied()
        };
        (0..N_PLACES).filter_map(error_m).collect()
    })
}

fn run(run: &Run) -> Findings {
    let measured = run.per_seed(N_SEEDS, errors_m);
    let means = |k: usize| measured.iter().map(|errors| mean_of(&errors[k])).collect::<Vec<f64>>();
    let (nearest, ordinary, modified) = (means(0), means(1), means(2));
    let pooled =
        [0, 1, 2].map(|k| measured.iter().flat_map(|errors| errors[k].clone()).collect::<Vec<f64>>());
    let lines: Vec<(&str, &[f64])> =
        METHODS.iter().zip(&pooled).map(|((name, ..), errors)| (*name, errors.as_slice())).collect();
    let mut findings = Findings::default();
    for ((_, _, id), means) in METHODS.iter().zip([&nearest, &ordinary, &modified]) {
        findings = findings.with(Finding::new(id, measured.len(), [Estimate::mean(means)]));
    }
    findings
        .with(
            Finding::new(
                "song-order",
                measured.len(),
                [Estimate::paired(&modified, &ordinary), Estimate::paired(&ordinary, &nearest)],
            )
            .because(
                "our ordinary filter is better than the paper's: a particle where nobody measured the field dies, which \
                 keeps all in the corridor",
            ),
        )
        .with_picture(Picture::of(
            format!(
                "Errors at {N_PLACES} places of {} rings: standing, after 15 steps, after 10 steps.",
                measured.len()
            ),
            cdf("Errors", "error (m)", &lines).to_svg(),
        ))
}
