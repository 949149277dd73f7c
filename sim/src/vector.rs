//! Vectors of three and unit quaternions, in plain arrays.

/// A vector: along the floor's x, its y, and up; or along the axes of a body or a device.
pub(crate) type Vector3 = [f64; 3];
/// A unit quaternion `[w, x, y, z]`.
pub(crate) type Quaternion = [f64; 4];

pub(crate) fn add(a: Vector3, b: Vector3) -> Vector3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(crate) fn subtract(a: Vector3, b: Vector3) -> Vector3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn scale(a: Vector3, s: f64) -> Vector3 {
    a.map(|c| c * s)
}

pub(crate) fn dot(a: Vector3, b: Vector3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn norm(a: Vector3) -> f64 {
    dot(a, a).sqrt()
}

pub(crate) fn cross(a: Vector3, b: Vector3) -> Vector3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The rotation by `angle_rad` about the unit vector `axis`, right-handed.
pub(crate) fn about(axis: Vector3, angle_rad: f64) -> Quaternion {
    let (sin, cos) = libm::sincos(0.5 * angle_rad);
    [cos, axis[0] * sin, axis[1] * sin, axis[2] * sin]
}

/// First `b`, then `a`.
pub(crate) fn compose(a: Quaternion, b: Quaternion) -> Quaternion {
    let (u, v) = ([a[1], a[2], a[3]], [b[1], b[2], b[3]]);
    let vector = add(add(scale(v, a[0]), scale(u, b[0])), cross(u, v));
    [a[0] * b[0] - dot(u, v), vector[0], vector[1], vector[2]]
}

pub(crate) fn inverse(q: Quaternion) -> Quaternion {
    [q[0], -q[1], -q[2], -q[3]]
}

pub(crate) fn rotate(q: Quaternion, v: Vector3) -> Vector3 {
    let u = [q[1], q[2], q[3]];
    let t = scale(cross(u, v), 2.0);
    add(add(v, scale(t, q[0])), cross(u, t))
}

pub(crate) fn rotate_back(q: Quaternion, v: Vector3) -> Vector3 {
    rotate(inverse(q), v)
}

/// The rotation a share `s` of the way from `a` to `b`, by the shorter way round.
pub(crate) fn between(a: Quaternion, b: Quaternion, s: f64) -> Quaternion {
    let turn = rotation_vector(compose(inverse(a), b));
    let angle_rad = norm(turn);
    if angle_rad < 1e-12 { a } else { compose(a, about(scale(turn, 1.0 / angle_rad), s * angle_rad)) }
}

/// The rotation as its axis times its angle in radians, the angle at most π.
pub(crate) fn rotation_vector(q: Quaternion) -> Vector3 {
    let sign = if q[0] < 0.0 { -1.0 } else { 1.0 };
    let v = scale([q[1], q[2], q[3]], sign);
    let sin = norm(v);
    let per_sin = if sin < 1e-9 { 2.0 } else { 2.0 * libm::atan2(sin, sign * q[0]) / sin };
    scale(v, per_sin)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    fn close(a: Vector3, b: Vector3) -> bool {
        norm(subtract(a, b)) < 1e-12
    }

    #[test]
    fn quaternions_rotate_right_handed() {
        let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
        assert!(close(rotate(about(z, FRAC_PI_2), x), y));
        assert!(close(rotate(compose(about(x, FRAC_PI_2), about(z, FRAC_PI_2)), x), z));
        assert!(close(rotate_back(about(z, FRAC_PI_2), y), x));
        assert!(close(rotation_vector(about(y, 0.7)), [0.0, 0.7, 0.0]));
        assert!(close(rotate(between(about(z, 0.2), about(z, 1.2), 0.5), x), rotate(about(z, 0.7), x)));
    }
}
