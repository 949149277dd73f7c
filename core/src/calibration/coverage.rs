//! How much of the sphere a set of directions covers.

/// Cells a face of the cube, along each side.
const CELLS_A_SIDE: usize = 2;

/// Cells of the sphere: a cube's faces, each cut into four; every cell is within 8 % of 4π/24.
const N_CELLS: usize = 6 * CELLS_A_SIDE * CELLS_A_SIDE;

/// Share of the cells of the sphere, seen from `centre`, that hold at least one point, 0 to 1.
pub(super) fn coverage(points: &[[f64; 3]], centre: [f64; 3]) -> f64 {
    let mut is_hit = [false; N_CELLS];
    for point in points {
        let direction = [0, 1, 2].map(|c| point[c] - centre[c]);
        if let Some(hit) = cell(direction).and_then(|cell| is_hit.get_mut(cell)) {
            *hit = true;
        }
    }
    is_hit.iter().filter(|&&hit| hit).count() as f64 / N_CELLS as f64
}

fn cell(direction: [f64; 3]) -> Option<usize> {
    let size = direction.map(f64::abs);
    if size.iter().all(|&c| c == 0.0) || direction.iter().any(|c| !c.is_finite()) {
        return None;
    }
    let axis = (0..3).fold(0, |best, c| if size[c] > size[best] { c } else { best });
    let is_positive = |c: usize| usize::from(direction[c % 3] > 0.0);
    Some(((axis * 2 + is_positive(axis)) * 2 + is_positive(axis + 1)) * 2 + is_positive(axis + 2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_cover_all_and_one_point_a_twenty_fourth() {
        let mut points = Vec::new();
        for long in 0..3 {
            for signs in 0..8u8 {
                points.push([0, 1, 2].map(|c| {
                    let size = if c == long { 3.0 } else { 1.0 };
                    if signs >> c & 1 == 1 { 10.0 + size } else { 10.0 - size }
                }));
            }
        }
        assert_eq!(coverage(&points, [10.0; 3]), 1.0);
        assert_eq!(coverage(&points[..1], [10.0; 3]), 1.0 / 24.0);
        assert_eq!(coverage(&[[10.0; 3], [f64::NAN; 3]], [10.0; 3]), 0.0);
    }
}
