//! What a file declares: which of its channels carry which records.

use std::collections::BTreeMap;

use mcap::records::{self, op};

use super::channel::Channel;
use super::losses::Losses;
use super::{Record, message};

/// The channels and schemas declared so far that are ours.
#[derive(Debug, Default)]
pub(super) struct Declared {
    schemas: BTreeMap<u16, Channel>,
    channels: BTreeMap<u16, Channel>,
}

impl Declared {
    /// Takes the channels of format version 1 as declared, in case the chunk that declares them is damaged.
    pub(super) fn assume_own(&mut self) {
        self.channels.extend(Channel::ALL.map(|channel| (channel.id(), channel)));
    }

    /// Whether nothing of ours has been declared.
    pub(super) fn is_empty(&self) -> bool {
        self.channels.is_empty()
    }

    /// Takes in one record of the file; gives what it holds if it is a message of ours.
    pub(super) fn take_in(&mut self, opcode: u8, body: &[u8], losses: &mut Losses) -> Option<Record> {
        if !matches!(opcode, op::SCHEMA | op::CHANNEL | op::MESSAGE) {
            return None;
        }
        match mcap::parse_record(opcode, body) {
            Ok(records::Record::Schema { header, .. }) => {
                let known = Channel::ALL
                    .into_iter()
                    .find(|channel| header.name == channel.schema_name() && header.encoding == "jsonschema");
                set(&mut self.schemas, header.id, known);
                None
            }
            Ok(records::Record::Channel(declared)) => {
                let of_schema = self.schemas.get(&declared.schema_id).copied();
                let known = of_schema.filter(|channel| {
                    declared.topic == channel.topic() && declared.message_encoding == "json"
                });
                set(&mut self.channels, declared.id, known);
                None
            }
            Ok(records::Record::Message { header, data }) => {
                let Some(&channel) = self.channels.get(&header.channel_id) else {
                    losses.n_foreign_messages += 1;
                    return None;
                };
                let record = message::decode(channel, header.log_time, &data);
                losses.n_malformed += u64::from(record.is_err());
                record.ok()
            }
            _ => {
                losses.n_malformed += 1;
                None
            }
        }
    }
}

fn set(map: &mut BTreeMap<u16, Channel>, id: u16, channel: Option<Channel>) {
    match channel {
        Some(channel) => map.insert(id, channel),
        None => map.remove(&id),
    };
}
