within AxisRig.Sensors;
block EdgeQueue "Rising edges under way, first in first out, at most four"
  parameter Units.Time delay(min = 0) = 0 "How long an edge is under way";
  input Boolean u "Input";
  output Integer arrived(start = 0, fixed = true) "Number of edges that have arrived";
  output Boolean waiting "An edge is under way";
protected
  constant Units.Time never = 1e60;
  Integer sent(start = 0, fixed = true) "Number of edges that have left";
  Integer write_slot(start = 0, fixed = true) "Next slot to fill";
  Integer read_slot(start = 0, fixed = true) "Slot of the next arrival";
  Units.Time due_0(start = never, fixed = true);
  Units.Time due_1(start = never, fixed = true);
  Units.Time due_2(start = never, fixed = true);
  Units.Time due_3(start = never, fixed = true);
  Units.Time next "When the next edge arrives";
equation
  when u then
    sent = pre(sent) + 1;
    write_slot = if pre(write_slot) > 2 then 0 else pre(write_slot) + 1;
    due_0 = if pre(write_slot) == 0 then time + delay else pre(due_0);
    due_1 = if pre(write_slot) == 1 then time + delay else pre(due_1);
    due_2 = if pre(write_slot) == 2 then time + delay else pre(due_2);
    due_3 = if pre(write_slot) == 3 then time + delay else pre(due_3);
  end when;
  next = if pre(read_slot) < 1 then due_0 elseif pre(read_slot) < 2 then due_1
    elseif pre(read_slot) < 3 then due_2
    else due_3;
  when sent > pre(arrived) and time >= next then
    arrived = pre(arrived) + 1;
    read_slot = if pre(read_slot) > 2 then 0 else pre(read_slot) + 1;
  end when;
  waiting = sent > arrived;
  assert(sent - arrived < 5, "more than four edges of one direction are under way");
  annotation(
    Documentation(info="<html>
<p>A ring of four slots holds the instants of arrival. Edges keep their order because the delay is
the same for all.</p>
</html>"));
end EdgeQueue;
