//! The commands.

pub mod card_walks;
pub mod demo;
pub mod energy;
pub mod evaluate;
pub mod import;
pub mod replay;
pub mod report;
pub mod reproduce;
pub mod simulate;
pub mod survey;
pub mod train;
