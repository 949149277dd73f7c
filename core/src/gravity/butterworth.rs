//! Butterworth low-pass filters of any order, designed in code.

use core::f64::consts::PI;

/// The highest order: above, second-order sections at phone rates lose digits for nothing.
const MAX_ORDER: usize = 8;

/// One second-order section, direct form II transposed: `b` over `1, a`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Section {
    b: [f64; 3],
    a: [f64; 2],
}

/// A low-pass whose pass band is as flat as its order allows, over a vector: the costly way to gravity.
///
/// At the cut-off the gain is `1/√2` at every order; in the pass band it is 1. The first input is taken to have been
/// there for ever, so there is no swing at the start.
///
/// # Source
/// Kwak 2018, §3.2 names an N-order Butterworth as what its Eq. 1 replaces; the design is the textbook's: the analogue
/// prototype's poles on the unit circle, frequency warped, through the bilinear transform.
#[derive(Clone, Debug, PartialEq)]
pub struct ButterworthLowPass {
    sections: Vec<Section>,
    /// State of each section, a vector each.
    states: Vec<[[f64; 2]; 3]>,
    has_input: bool,
}

impl ButterworthLowPass {
    /// A filter of `order` 1 to 8 with `cutoff_hz` below half of `rate_hz`; nothing for other numbers.
    pub fn new(order: usize, cutoff_hz: f64, rate_hz: f64) -> Option<Self> {
        let is_valid = (1..=MAX_ORDER).contains(&order)
            && rate_hz.is_finite()
            && cutoff_hz > 0.0
            && cutoff_hz < 0.5 * rate_hz;
        if !is_valid {
            return None;
        }
        // The bilinear transform bends the frequency axis; this analogue cut-off lands on the wanted one.
        let warped = libm::tan(PI * cutoff_hz / rate_hz);
        let mut sections = Vec::with_capacity(order.div_ceil(2));
        for k in 0..order / 2 {
            // A pole pair of the prototype: s² + 2·sin(θ)·s + 1, θ its angle from the imaginary axis.
            let theta = PI * (2.0 * k as f64 + 1.0) / (2.0 * order as f64);
            let damping = 2.0 * libm::sin(theta);
            let (square, cross) = (warped * warped, damping * warped);
            let norm = 1.0 + cross + square;
            let gain = square / norm;
            sections.push(Section {
                b: [gain, 2.0 * gain, gain],
                a: [2.0 * (square - 1.0) / norm, (1.0 - cross + square) / norm],
            });
        }
        if order % 2 == 1 {
            // The real pole, as a section whose second half is empty.
            let gain = warped / (1.0 + warped);
            sections.push(Section { b: [gain, gain, 0.0], a: [(warped - 1.0) / (warped + 1.0), 0.0] });
        }
        let states = vec![[[0.0; 2]; 3]; sections.len()];
        Some(Self { sections, states, has_input: false })
    }

    /// Feeds `input` and returns the output; an input that is not finite changes nothing and returns nothing.
    pub fn update(&mut self, input: [f32; 3]) -> Option<[f32; 3]> {
        if input.iter().any(|c| !c.is_finite()) {
            return None;
        }
        let mut value = input.map(f64::from);
        if !self.has_input {
            self.settle(value);
            self.has_input = true;
        }
        for (section, state) in self.sections.iter().zip(&mut self.states) {
            for (value, state) in value.iter_mut().zip(state) {
                let y = section.b[0] * *value + state[0];
                state[0] = section.b[1] * *value - section.a[0] * y + state[1];
                state[1] = section.b[2] * *value - section.a[1] * y;
                *value = y;
            }
        }
        Some(value.map(|c| c as f32))
    }

    /// The gain at `frequency_hz`, at the sampling rate `rate_hz` that the filter was made for.
    pub fn gain(&self, frequency_hz: f64, rate_hz: f64) -> f64 {
        let (sin, cos) = libm::sincos(2.0 * PI * frequency_hz / rate_hz);
        let (sin2, cos2) = (2.0 * sin * cos, 2.0 * cos * cos - 1.0);
        let square = |c0: f64, c1: f64, c2: f64| {
            let (re, im) = (c0 + c1 * cos + c2 * cos2, -(c1 * sin + c2 * sin2));
            re * re + im * im
        };
        let of = |s: &Section| square(s.b[0], s.b[1], s.b[2]) / square(1.0, s.a[0], s.a[1]);
        self.sections.iter().map(of).product::<f64>().sqrt()
    }

    /// The state that an input leaves which was there for ever: every section's output is its input.
    fn settle(&mut self, input: [f64; 3]) {
        for (section, state) in self.sections.iter().zip(&mut self.states) {
            for (x, state) in input.iter().zip(state) {
                state[1] = (section.b[2] - section.a[1]) * x;
                state[0] = (section.b[1] - section.a[0]) * x + state[1];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_second_order_at_a_quarter_of_the_rate_by_hand() {
        // tan(π/4) = 1: norm = 2 + √2, b = 1/(2 + √2)·(1, 2, 1), a = (0, (2 − √2)/(2 + √2)).
        let filter = ButterworthLowPass::new(2, 25.0, 100.0).unwrap();
        let section = filter.sections[0];
        assert!(
            (section.b[0] - 0.292_893_218_8).abs() < 1e-10 && (section.b[1] - 0.585_786_437_6).abs() < 1e-10
        );
        assert!(section.a[0].abs() < 1e-12 && (section.a[1] - 0.171_572_875_3).abs() < 1e-10);
    }

    #[test]
    fn the_first_order_at_a_quarter_of_the_rate_by_hand() {
        // b = (1/2, 1/2), a = 0: the mean of the last two inputs.
        let mut filter = ButterworthLowPass::new(1, 25.0, 100.0).unwrap();
        assert_eq!(filter.update([2.0, 0.0, -4.0]), Some([2.0, 0.0, -4.0]));
        let out = filter.update([4.0, 1.0, 0.0]).unwrap();
        assert!((0..3).all(|c| (out[c] - [3.0, 0.5, -2.0][c]).abs() < 1e-6), "{out:?}");
    }

    #[test]
    fn numbers_without_a_filter_are_refused() {
        for (order, cutoff_hz, rate_hz) in
            [(0, 1.0, 100.0), (9, 1.0, 100.0), (2, 0.0, 100.0), (2, 50.0, 100.0), (2, f64::NAN, 100.0)]
        {
            assert_eq!(ButterworthLowPass::new(order, cutoff_hz, rate_hz), None);
        }
        let mut filter = ButterworthLowPass::new(3, 1.0, 100.0).unwrap();
        assert_eq!(filter.update([f32::NAN, 0.0, 0.0]), None);
    }

    #[test]
    fn gravity_stays_and_steps_go() {
        let mut filter = ButterworthLowPass::new(4, 0.5, 50.0).unwrap();
        let mut last = [0.0; 3];
        for k in 0..1_000 {
            let bob = 3.0 * libm::sinf(2.0 * core::f32::consts::TAU * k as f32 / 50.0);
            last = filter.update([0.0, 0.5, 9.81 + bob]).unwrap();
        }
        assert!((last[2] - 9.81).abs() < 0.02 && (last[1] - 0.5).abs() < 1e-4, "{last:?}");
    }

    proptest! {
        #[test]
        fn half_the_power_passes_at_the_cutoff(order in 1usize..=8, share in 0.001f64..0.49) {
            let filter = ButterworthLowPass::new(order, share * 100.0, 100.0).unwrap();
            prop_assert!((filter.gain(share * 100.0, 100.0) - 0.5f64.sqrt()).abs() < 1e-6);
            prop_assert!((filter.gain(0.0, 100.0) - 1.0).abs() < 1e-6);
            prop_assert!(filter.gain(50.0, 100.0) < 1e-6);
        }

        #[test]
        fn a_constant_passes_unchanged_from_the_first(order in 1usize..=8, x in -50.0f32..50.0) {
            let mut filter = ButterworthLowPass::new(order, 2.0, 100.0).unwrap();
            for _ in 0..50 {
                let out = filter.update([x, 0.0, -x]).unwrap();
                prop_assert!((out[0] - x).abs() < 1e-3 && (out[2] + x).abs() < 1e-3, "{out:?}");
            }
        }
    }
}
