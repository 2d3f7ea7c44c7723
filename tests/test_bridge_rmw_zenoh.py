"""Names, tokens and attachments are those of rmw_zenoh; examples are from its design document."""

from __future__ import annotations

import struct

import pytest

from contactsense.bridge.rmw_zenoh import Attachments, Graph, Losses, dds_type, key_expression

STRING = "std_msgs/msg/String"
HASH = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"


def test_types_have_the_names_of_dds() -> None:
    assert dds_type(STRING) == "std_msgs::msg::dds_::String_"


@pytest.mark.parametrize(
    ("topic", "wanted"),
    [
        ("/chatter", f"0/chatter/std_msgs::msg::dds_::String_/{HASH}"),
        ("/robot1/chatter", f"0/robot1/chatter/std_msgs::msg::dds_::String_/{HASH}"),
    ],
)
def test_key_expressions_of_topics(topic: str, wanted: str) -> None:
    assert key_expression(0, topic, STRING, HASH) == wanted


def test_hashes_are_those_of_ros() -> None:
    pytest.importorskip("rosbags")
    from contactsense.offline.ros_messages import Messages

    assert Messages().type_hash(STRING) == HASH


def test_tokens_of_a_node_and_its_topics() -> None:
    graph = Graph(2, "8b20917502ee955ac4476e0266340d5c", "talker")
    session = "@ros2_lv/2/8b20917502ee955ac4476e0266340d5c"
    assert graph.node_token() == f"{session}/0/0/NN/%/%/talker"
    of_topic = f"%/%/talker/%robot1%chatter/std_msgs::msg::dds_::String_/{HASH}"
    topic = "/robot1/chatter"
    assert graph.publisher_token(10, topic, STRING, HASH) == f"{session}/0/10/MP/{of_topic}/::,10:,:,:,,"
    assert graph.subscription_token(3, topic, STRING, HASH) == f"{session}/0/3/MS/{of_topic}/2::,10:,:,:,,"


def test_attachments_count_from_one() -> None:
    attachments = Attachments("token")
    first, second = attachments.next(7), attachments.next(8)
    assert len(first) == 33
    assert struct.unpack("<qqB", first[:17]) == (1, 7, 16)
    assert struct.unpack("<qqB", second[:17]) == (2, 8, 16)
    assert first[17:] == second[17:] != Attachments("other").next(7)[17:]


def test_losses_are_counted_by_sender() -> None:
    losses, one, two = Losses(), Attachments("one"), Attachments("two")
    assert [losses.before(it.next(0)) for it in (one, two, one, two)] == [0, 0, 0, 0]
    one.next(0), one.next(0)
    assert losses.before(one.next(0)) == 2
    assert losses.before(two.next(0)) == 0
    # A sender that starts again counts from one.
    assert losses.before(Attachments("one").next(0)) == 0
    assert losses.before(b"") == losses.before(b"x" * 33) == 0


def test_many_senders_are_not_remembered_without_end() -> None:
    losses = Losses()
    for number in range(1000):
        losses.before(Attachments(str(number)).next(0))
    assert len(losses._last) <= 64
