//! The commands.

pub mod evaluate;
pub mod replay;
pub mod survey;
