//! The commands.

pub mod demo;
pub mod evaluate;
pub mod replay;
pub mod survey;
pub mod train;
