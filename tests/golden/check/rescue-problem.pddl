(define (problem two-targets)
  (:domain rescue)
  (:objects
    e1 - explorer
    c1 - clearer
    start - location
    t1 t2 - mission_target
    b1 - blockade)
  (:init
    (at e1 start)
    (at c1 start)
    (= (size b1) 30)
    (= (distance start t1) 12)
    (= (distance t1 t2) 8)
    (= (distance start b1) 5))
  (:goal (and (explored t1) (explored t2) (cleared b1))))
