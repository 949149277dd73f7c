//! Phones: how they are carried, and what their sensors say.

mod carry;
mod hold;
mod iron;
mod motion;
mod sensors;

pub use carry::{CarryMode, Grip};
pub use motion::{Carried, Pose};
pub(crate) use sensors::Sensor;
pub use sensors::{Magnetometer, PhoneModel, SensorModel};
