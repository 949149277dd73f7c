//! Histories of the field: what a particle would have read along its way, compared with what was read.

mod device;
mod distance;

pub use device::DeviceHistory;
pub use distance::{dynamic_time_warping_ut, euclidean_ut};

use serde::{Deserialize, Serialize};

use crate::magnetic::feature::FieldRead;
use crate::map::FloorIndex;
use crate::particle::Particles;

use device::Taken;
use distance::{LANES, Lanes, off_sums, remove_means, squares, warped};

/// Parameters of the weight by the distance of histories.
///
/// # Source
/// Kwak 2018, §6.3.1: 30 s, which are 90 reads of a card. σ is not given; the defaults of the recipes are ours.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HistoryParams {
    /// How two histories are compared.
    pub metric: HistoryMetric,
    /// What is compared.
    pub feature: HistoryFeature,
    /// Reads that a history holds at most: three a round of a card, [`reads_a_move`](Self::reads_a_move) a step of a
    /// phone.
    pub window: usize,
    /// Reads kept of one move, 1 or 3: one is the mean of its thirds, and stands for the middle of the move.
    pub reads_a_move: u8,
    /// σ of the weight, in µT: the larger, the less a distance counts.
    pub sigma_ut: f32,
    /// Whether a history that helped a particle to be drawn again counts no more for what it counted then; else every
    /// resampling counts the whole history anew.
    pub counts_once: bool,
}

/// How two histories are compared; both have their means removed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HistoryMetric {
    /// Read by read.
    ///
    /// # Source
    /// Kwak 2018, Eq. 5.
    Euclidean,
    /// Along the warping of time that makes the distance least.
    ///
    /// # Source
    /// Kwak 2018, §5.3.3: what Magicol and others use.
    DynamicTimeWarping {
        /// No read is compared with one farther away than this, in reads (the band of Sakoe and Chiba); nothing for any.
        band: Option<usize>,
    },
}

/// What of the field is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HistoryFeature {
    /// `|B|`.
    Strength,
    /// `B_h` and `B_v`; a read of which `|B|` alone is known is compared by that, as one term where others are two.
    HorizontalVertical,
}

/// Memory that one update needs and the next does not remember.
#[derive(Clone, Debug, Default)]
pub struct HistoryScratch {
    /// The slots from the oldest to the newest.
    order: Vec<usize>,
    /// The device's components and, of all reads, its strengths, in order of time and with their means removed.
    device_ut: [Vec<f32>; 3],
    /// The same of some particles.
    particles_ut: [Vec<Lanes>; 3],
    column: Vec<Lanes>,
}

impl HistoryScratch {
    /// Room for histories of `n_slots`.
    pub fn with_capacity(n_slots: usize) -> Self {
        Self {
            order: Vec::with_capacity(n_slots),
            device_ut: [(); 3].map(|()| Vec::with_capacity(n_slots)),
            particles_ut: [(); 3].map(|()| Vec::with_capacity(n_slots)),
            column: Vec::with_capacity(n_slots + 1),
        }
    }
}

impl HistoryParams {
    /// Slots of a history: as many as reads.
    pub(crate) fn n_slots(&self) -> usize {
        self.window.max(1)
    }

    /// Numbers that a particle's history takes: a plane of slots for each component.
    pub(crate) fn n_values(&self) -> usize {
        self.n_slots() * self.n_components()
    }

    /// Sums that are kept of a particle's history, so that its distance need not be summed anew.
    pub(crate) fn n_sums(&self) -> usize {
        match self.metric {
            HistoryMetric::Euclidean => 2 * self.n_components(),
            HistoryMetric::DynamicTimeWarping { .. } => 0,
        }
    }

    fn n_components(&self) -> usize {
        match self.feature {
            HistoryFeature::Strength => 1,
            HistoryFeature::HorizontalVertical => 2,
        }
    }
}

fn strength_ut([horizontal_ut, vertical_ut]: [f32; 2]) -> f32 {
    (horizontal_ut * horizontal_ut + vertical_ut * vertical_ut).sqrt()
}

/// After a move from `from_m` to where the particles are now: takes `reads` into the device's history and what the map
/// says along each particle's move into the particle's, and weighs each particle by the distance of the two.
///
/// Read `k` of a move's three stands for the middle of its third: for (2k + 1)/6 of the way. The weight of the last
/// round is taken back before the new one is given: `log_weight += −‖d‖²/2σ² − (the last such term)`, so that
/// histories are weighed afresh and what else weighs on a particle stays. A place of which the map knows nothing reads
/// as the floor's mean.
///
/// # Source
/// Kwak 2018, Eqs 4–5: `w = α·exp(−‖d‖²/2σ²)`; α cancels when weights are normalised.
pub fn update(
    params: &HistoryParams,
    floor: &FloorIndex,
    reads: &[Option<FieldRead>; 3],
    from_m: [&[f32]; 2],
    device: &mut DeviceHistory,
    particles: &mut Particles,
    scratch: &mut HistoryScratch,
) {
    let single = [mean(reads)];
    let (reads, n_thirds): (&[_], _) = if params.reads_a_move <= 1 { (&single, 1) } else { (reads, 3) };
    for (k, read) in reads.iter().enumerate() {
        let Some(taken) = read.as_ref().and_then(|read| device.push(params, read)) else { continue };
        let share = (2 * k + 1) as f32 / (2 * n_thirds) as f32;
        remember(params, floor, &taken, share, from_m, particles);
        if params.n_sums() > 0 && taken.slot + 1 == params.n_slots() {
            sum_anew(params, device, particles);
        }
    }
    if device.is_empty() {
        return;
    }
    let weigh = |i: usize, square_ut2: f32, particles: &mut Particles| {
        let log_weight = -square_ut2 / (2.0 * params.sigma_ut * params.sigma_ut);
        particles.log_weight[i] += log_weight - particles.history_log_weight[i];
        particles.history_log_weight[i] = log_weight;
    };
    let n_values = params.n_values();
    match params.metric {
        HistoryMetric::Euclidean => {
            let (n_sums, is_mixed) = (params.n_sums(), device.has_strength_alone());
            for i in 0..particles.len() {
                let square_ut2 = if is_mixed {
                    mixed_square_ut2(params, device, &particles.history_ut[i * n_values..(i + 1) * n_values])
                } else {
                    centred_square_ut2(&particles.history_sums[i * n_sums..(i + 1) * n_sums], device.len())
                };
                weigh(i, square_ut2, particles);
            }
        }
        HistoryMetric::DynamicTimeWarping { band } => {
            lay_out_device(device, scratch);
            for first in (0..particles.len()).step_by(LANES) {
                let squares_ut2 = warped_squares_ut2(params, device, first, particles, band, scratch);
                for (lane, square_ut2) in squares_ut2.into_iter().enumerate() {
                    if first + lane < particles.len() {
                        weigh(first + lane, square_ut2, particles);
                    }
                }
            }
        }
    }
}

/// Starts all histories anew, and takes back what they weighed.
pub fn forget(params: &HistoryParams, device: &mut DeviceHistory, particles: &mut Particles) {
    device.start_anew(params);
    particles.history_sums.fill(0.0);
    for (log_weight, of_history) in particles.log_weight.iter_mut().zip(&mut particles.history_log_weight) {
        *log_weight -= core::mem::take(of_history);
    }
}

/// The mean of what was read during a move; nothing where nothing was.
fn mean(reads: &[Option<FieldRead>; 3]) -> Option<FieldRead> {
    let known = || reads.iter().flatten();
    let n = known().count() as f32;
    let level = || known().filter_map(|read| read.horizontal_vertical_ut);
    let n_level = level().count() as f32;
    let level_mean = |c: usize| level().map(|read_ut| read_ut[c]).sum::<f32>() / n_level;
    (n > 0.0).then(|| FieldRead {
        strength_ut: known().map(|read| read.strength_ut).sum::<f32>() / n,
        horizontal_vertical_ut: (n_level > 0.0).then(|| [level_mean(0), level_mean(1)]),
    })
}

/// Writes what the map says at `share` of each particle's move into its history's slot, and keeps its sums.
fn remember(
    params: &HistoryParams,
    floor: &FloorIndex,
    taken: &Taken,
    share: f32,
    [from_x_m, from_y_m]: [&[f32]; 2],
    particles: &mut Particles,
) {
    let (n_slots, n_values, n_sums) = (params.n_slots(), params.n_values(), params.n_sums());
    for i in 0..particles.x_m.len() {
        let ([x_m, y_m], [from_x_m, from_y_m]) =
            ([particles.x_m[i], particles.y_m[i]], [from_x_m[i], from_y_m[i]]);
        let [strength_ut, horizontal_ut, vertical_ut] =
            floor.read_or_mean(from_x_m + share * (x_m - from_x_m), from_y_m + share * (y_m - from_y_m));
        let said_ut = match params.feature {
            HistoryFeature::Strength => [strength_ut, 0.0],
            HistoryFeature::HorizontalVertical => [horizontal_ut, vertical_ut],
        };
        let history_ut = &mut particles.history_ut[i * n_values..(i + 1) * n_values];
        let sums = &mut particles.history_sums[i * n_sums..(i + 1) * n_sums];
        for (c, plane_ut) in history_ut.chunks_exact_mut(n_slots).enumerate() {
            let forgotten_ut = core::mem::replace(&mut plane_ut[taken.slot], said_ut[c]);
            if let Some([sum_ut, square_ut2]) =
                sums.get_mut(2 * c..2 * c + 2).and_then(|sums| sums.first_chunk_mut())
            {
                let removed_ut = taken.removed_ut.map_or(0.0, |read_ut| forgotten_ut - read_ut[c]);
                let added_ut = taken.added_ut.map_or(0.0, |read_ut| said_ut[c] - read_ut[c]);
                *sum_ut += added_ut - removed_ut;
                *square_ut2 += added_ut * added_ut - removed_ut * removed_ut;
            }
        }
    }
}

/// Sums the histories from the beginning: what rounding has left in the sums is gone. For once a turn of the ring.
fn sum_anew(params: &HistoryParams, device: &DeviceHistory, particles: &mut Particles) {
    if device.has_strength_alone() {
        // The sums are of the other reads; the next turn will do.
        return;
    }
    let n = device.len();
    let histories_ut = particles.history_ut.chunks_exact(params.n_values());
    for (history_ut, sums) in histories_ut.zip(particles.history_sums.chunks_exact_mut(params.n_sums())) {
        let planes = history_ut.chunks_exact(params.n_slots()).zip(&device.planes_ut);
        for ((own_ut, read_ut), sums) in planes.zip(sums.chunks_exact_mut(2)) {
            sums.copy_from_slice(&off_sums(&own_ut[..n], read_ut));
        }
    }
}

/// `‖d‖²` of a history of `n` reads by its sums: `Σ e² − (Σ e)²/n` of each component.
fn centred_square_ut2(sums: &[f32], n: usize) -> f32 {
    let of_component = |[sum_ut, square_ut2]: &[f32; 2]| square_ut2 - sum_ut * sum_ut / n as f32;
    // Rounding may leave less than nothing.
    sums.as_chunks().0.iter().map(of_component).sum::<f32>().max(0.0)
}

/// The same where of some reads the strength alone is known.
///
/// Components are compared where both are known. The mean that is taken from the strengths is of all reads, since that
/// of a round or two would take their whole pattern away.
fn mixed_square_ut2(params: &HistoryParams, device: &DeviceHistory, history_ut: &[f32]) -> f32 {
    let (horizontal_ut, vertical_ut) = history_ut.split_at(params.n_slots());
    let off_ut = |k: usize| {
        let [read_horizontal_ut, read_vertical_ut] = device.read_ut(k);
        [horizontal_ut[k] - read_horizontal_ut, vertical_ut[k] - read_vertical_ut]
    };
    let strength_off_ut = |k: usize| strength_ut([horizontal_ut[k], vertical_ut[k]]) - device.strength_ut(k);
    let (mut sums_ut, mut n_level, mut strength_sum_ut) = ([0.0f32; 2], 0.0f32, 0.0f32);
    for k in 0..device.len() {
        strength_sum_ut += strength_off_ut(k);
        if !device.is_strength_alone[k] {
            n_level += 1.0;
            let off_ut = off_ut(k);
            sums_ut = [sums_ut[0] + off_ut[0], sums_ut[1] + off_ut[1]];
        }
    }
    let means_ut = sums_ut.map(|sum_ut| sum_ut / n_level.max(1.0));
    let strength_mean_ut = strength_sum_ut / device.len() as f32;
    let square_ut2 = |k: usize| {
        if device.is_strength_alone[k] {
            let off_ut = strength_off_ut(k) - strength_mean_ut;
            return off_ut * off_ut;
        }
        let [first_ut, second_ut] = off_ut(k);
        let (first_ut, second_ut) = (first_ut - means_ut[0], second_ut - means_ut[1]);
        first_ut * first_ut + second_ut * second_ut
    };
    (0..device.len()).map(square_ut2).sum()
}

/// Lays the device's reads out in order of time, their means removed as [`mixed_square_ut2`] removes them.
fn lay_out_device(device: &DeviceHistory, scratch: &mut HistoryScratch) {
    scratch.order.clear();
    scratch.order.extend(device.order());
    for (c, row_ut) in scratch.device_ut.iter_mut().enumerate() {
        let value_ut = |slot: usize| if c == 2 { device.strength_ut(slot) } else { device.read_ut(slot)[c] };
        let counts = |slot: &usize| c == 2 || !device.is_strength_alone[*slot];
        let n = scratch.order.iter().copied().filter(counts).count() as f32;
        let mean_ut = scratch.order.iter().copied().filter(counts).map(value_ut).sum::<f32>() / n.max(1.0);
        row_ut.clear();
        row_ut.extend(scratch.order.iter().map(|&slot| value_ut(slot) - mean_ut));
    }
}

/// `‖d‖²` under time warping of [`LANES`] particles from `first` on, after [`lay_out_device`].
fn warped_squares_ut2(
    params: &HistoryParams,
    device: &DeviceHistory,
    first: usize,
    particles: &Particles,
    band: Option<usize>,
    scratch: &mut HistoryScratch,
) -> Lanes {
    let (n_slots, n_values, n_components) = (params.n_slots(), params.n_values(), params.n_components());
    let n = device.len();
    let HistoryScratch { order, device_ut, particles_ut, column } = scratch;
    let is_mixed = device.has_strength_alone();
    // A lane beyond the last particle repeats it; nobody reads its result.
    let starts: [usize; LANES] =
        core::array::from_fn(|lane| (first + lane).min(particles.len() - 1) * n_values);
    let rows = |c: usize, slot: usize| starts.map(|start| particles.history_ut[start + c * n_slots + slot]);
    for (c, plane) in particles_ut.iter_mut().enumerate() {
        plane.clear();
        if c < n_components {
            plane.extend(order.iter().map(|&slot| rows(c, slot)));
        } else if c == 2 && is_mixed {
            plane.extend(order.iter().map(|&slot| {
                let (horizontal_ut, vertical_ut) = (rows(0, slot), rows(1, slot));
                core::array::from_fn(|lane| strength_ut([horizontal_ut[lane], vertical_ut[lane]]))
            }));
        }
        remove_means(plane, |k| c == 2 || !device.is_strength_alone[order[k]]);
    }
    let [a, b, strength] = &*particles_ut;
    let [read_a_ut, read_b_ut, read_strength_ut] = &*device_ut;
    if n_components == 1 {
        return warped([n, n], band, |i, j| squares(&a[i], read_a_ut[j]), column);
    }
    let both = |i: usize, j: usize| {
        let (first, second) = (squares(&a[i], read_a_ut[j]), squares(&b[i], read_b_ut[j]));
        core::array::from_fn(|lane| first[lane] + second[lane])
    };
    if !is_mixed {
        return warped([n, n], band, both, column);
    }
    let mixed = |i: usize, j: usize| {
        if device.is_strength_alone[order[j]] {
            squares(&strength[i], read_strength_ut[j])
        } else {
            both(i, j)
        }
    };
    warped([n, n], band, mixed, column)
}

#[cfg(test)]
mod tests;
