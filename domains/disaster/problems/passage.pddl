(define (problem passage)
  (:domain disaster)
  (:objects
    blockade_1 - blockade
    clearer_1 - clearer
    explorer_1 - explorer
    explorer_1_place clearer_1_place - free_location
    target_1 - mission_target)
  (:init
    (= (x target_1) 12.5)
    (= (y target_1) 1.5)
    (= (x blockade_1) 7)
    (= (y blockade_1) 3)
    (= (x-from blockade_1) 7)
    (= (y-from blockade_1) 2.5)
    (= (x-to blockade_1) 7)
    (= (y-to blockade_1) 3.5)
    (= (clear-duration blockade_1) 20)
    (= (speed explorer_1) 1)
    (= (radius explorer_1) 0.3)
    (= (x explorer_1_place) 1.5)
    (= (y explorer_1_place) 3)
    (at explorer_1 explorer_1_place)
    (= (speed clearer_1) 1)
    (= (radius clearer_1) 0.3)
    (= (x clearer_1_place) 1.5)
    (= (y clearer_1_place) 5)
    (at clearer_1 clearer_1_place))
  (:goal (and
    (explored target_1)))
  (:metric minimize (total-time)))
